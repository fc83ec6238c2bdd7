"""How many tests set two rivals apart: in the order that `hjcamp next` proposes, and in random order.

    python benchmarks/next_value.py [--random 4] [--pairs 14] [--rigs 2] [--workers 2] > docs/next_value.md

For each pair the truth plant of the tests, which shares no code with the model, hides the first effect in rigs of their
own, at medium and at weak strength. The first tests are one condition with three repetitions. Both rivals are fitted to
them; then one test after the other (one repetition each) is run on the truth plant, both rivals are refitted on all tests,
and weighed as a diagnosis weighs them. They are apart when the true one has 95 % of the weight. Proposals are made anew
after every two tests. Pairs that the first tests set apart, and pairs that no order sets apart (a pressure offset is a
friction asymmetry to every test), say nothing of the order and are left out of the means.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from next_value_duel import APART, MOST, Duel

from hjcamp.discrepancy.next_menu import menu
from hjcamp.effects import load_effects

PAIRS = (
    ("leakage", "tubing_creep"),
    ("tubing_creep", "cross_leakage"),
    ("entrained_air", "line_resistance"),
    ("line_resistance", "line_inertance"),
    ("static_friction_ageing", "stribeck_friction"),
    ("stribeck_friction", "presliding"),
    ("presliding", "string_elasticity"),
    ("position_friction", "pressure_friction"),
    ("pressure_friction", "friction_drift"),
    ("pressure_gain", "friction_drift"),
    ("pressure_offset", "position_friction"),
    ("encoder_lag", "line_inertance"),
    ("pump_backlash", "string_elasticity"),
    ("dither_relief", "stribeck_friction"),
)
STRENGTHS = ("medium", "weak")
FIRST_SEED = 40300


@dataclass(frozen=True)
class Outcome:
    """Row of the table, and how many tests were needed in the proposed order and in each random one; none: says nothing."""

    row: str
    ours: int | None = None
    theirs: tuple[int, ...] = ()


def outcome(number: int, strength: str, names: tuple[str, str], orders: int) -> Outcome:
    """Return how the duel of two rivals on one rig ends."""
    effects = tuple(load_effects().values())
    choices = [one for one in menu() if not {"payload", "orientation"} & set(one.settings)]
    duel = Duel(names, strength, FIRST_SEED + number, effects, choices)
    _, weight = duel.refit(duel.first, dict(duel.start))
    row = f"| {names[0]} | {strength} | {names[1]} |"
    if weight > APART:
        return Outcome(f"{row} apart from the start | |")
    mine = duel.needed([])
    random = np.random.default_rng([7, number])
    tried = [random.permutation(len(choices))[:MOST] for _ in range(orders)]
    others = tuple(duel.needed([choices[k] for k in order]) for order in tried)
    row += f" {mine} | {', '.join(map(str, others))} |"
    return Outcome(row, mine, others) if min(mine, *others) <= MOST else Outcome(row)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--random", type=int, default=4, help="random orders for each rig")
    parser.add_argument("--pairs", type=int, default=len(PAIRS))
    parser.add_argument("--rigs", type=int, default=2, help="rigs for each pair and strength")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    options = parser.parse_args()
    began = time.perf_counter()
    duels = [
        (strength, names) for strength in STRENGTHS for names in PAIRS[: options.pairs] for _ in range(options.rigs)
    ]
    print("# Tests needed to set two rivals apart\n")
    print("Made by `python benchmarks/next_value.py`; its head says how. A test is one repetition of one condition;")
    print(f"at most {MOST} are run, {MOST + 1} means not apart by then.\n")
    print("| truth | strength | rival | proposed order | random order (each) |\n|---|---|---|---|---|", flush=True)
    ours, ratios, theirs = list[int](), list[float](), list[int]()
    with ProcessPoolExecutor(options.workers, multiprocessing.get_context("spawn")) as pool:
        begun = [pool.submit(outcome, k, *duel, options.random) for k, duel in enumerate(duels)]
        for one in begun:
            found = one.result()
            print(found.row, flush=True)
            if found.ours is not None:
                ours.append(found.ours)
                theirs += found.theirs
                ratios.append(float(np.mean(found.theirs)) / found.ours)
    if not ours:
        print("\nNo duel says anything of the order.")
        return
    times = float(np.mean(theirs) / np.mean(ours))
    fewer = sum(ratio > 1.0 for ratio in ratios)
    print(f"\nMedian: {np.median(ours):g} proposed, {np.median(theirs):g} random;", end=" ")
    print(f"mean {np.mean(ours):.2f} and {np.mean(theirs):.2f},")
    print(f"{times:.1f} times fewer, over {len(ours)} duels of {len(duels)} ({resampled(ours, ratios)}).")
    print(f"Fewer than the mean of the random orders in {fewer}. {time.perf_counter() - began:.0f} s.")


def resampled(ours: list[int], ratios: list[float]) -> str:
    """Return the 90 % interval of the ratio of means, duels drawn anew."""
    random = np.random.default_rng(8)
    mine = np.array(ours, dtype=np.float64)
    others = mine * np.array(ratios)
    drawn = random.integers(len(mine), size=(2000, len(mine)))
    low, high = np.quantile(others[drawn].sum(axis=1) / mine[drawn].sum(axis=1), [0.05, 0.95])
    return f"90 % interval {low:.1f} to {high:.1f}"


if __name__ == "__main__":
    main()
