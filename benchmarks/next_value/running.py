"""How many tests set two rivals apart: in the order that `hjcamp next` proposes, and in random order.

    python -m benchmarks.next_value [--random 4] [--pairs 14] [--rigs 2] [--workers 2 | --cluster ADDRESS] [--page docs/next_value.md]

For each pair the truth plant of the tests, which shares no code with the model, hides the first effect in rigs of their
own, at medium and at weak strength. The first tests are one condition with three repetitions. Both rivals are fitted to
them; then one test after the other (one repetition each) is run on the truth plant, both rivals are refitted on all tests,
and weighed as a diagnosis weighs them. They are apart when the true one has 95 % of the weight. Proposals are made anew
after every two tests. Pairs that the first tests set apart, and pairs that no order sets apart (a pressure offset is a
friction asymmetry to every test), say nothing of the order and are left out of the means. Finished duels are kept in a
ledger, from which the same command goes on as long as the code it runs is the same.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.hidden_effects.ledger import Ledger, code_version
from benchmarks.hidden_effects.one_case import alone
from benchmarks.hidden_effects.running import THREADS, stop
from benchmarks.next_value.duel import APART, MOST, Duel
from benchmarks.next_value.page import LEDGER, Question, page
from benchmarks.on_cluster import there
from hjcamp.effects import load_effects
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.diagnosis.design.menu import menu
from hjcamp.storage import write_whole

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
SEEDS_OF_A_STRENGTH = 500


def questions(pairs: int, rigs: int, orders: int) -> list[Question]:
    """Return the duels of the study; more rigs or fewer pairs leave the seeds of the others as they are."""
    found = []
    for strength, first in zip(STRENGTHS, (0, SEEDS_OF_A_STRENGTH), strict=True):
        for place, names in enumerate(PAIRS[:pairs]):
            found += [Question(first + place + len(PAIRS) * rig, strength, names, orders) for rig in range(rigs)]
    return found


def outcome(asked: Question) -> dict[str, Any]:
    """Return how a duel on one rig ends: tests needed in the proposed order and in each random one; None: apart before."""
    effects = tuple(load_effects().values())
    choices = [one for one in menu() if not {"payload", "orientation"} & set(one.settings)]
    duel = Duel(asked.names, asked.strength, FIRST_SEED + asked.number, effects, choices)
    _, weight = duel.refit(duel.first, dict(duel.start))
    line: dict[str, Any] = {"name": asked.name, "ours": None, "theirs": []}
    if weight > APART:
        return line
    line["ours"] = duel.needed([])
    random = np.random.default_rng([7, asked.number])
    tried = [random.permutation(len(choices))[:MOST] for _ in range(asked.orders)]
    line["theirs"] = [duel.needed([choices[k] for k in order]) for order in tried]
    return line


def main(arguments: Sequence[str] | None = None) -> int:
    """Fight the duels that the ledger does not have, then write the table; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--random", type=int, default=4, help="random orders for each rig")
    parser.add_argument("--pairs", type=int, default=len(PAIRS))
    parser.add_argument("--rigs", type=int, default=2, help="rigs for each pair and strength")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--cluster", metavar="ADDRESS", help="a dask scheduler whose workers see this folder, or local")
    parser.add_argument("--ledger", type=Path, default=LEDGER, metavar="FILE", help="one JSON line for each duel")
    parser.add_argument("--page", type=Path, metavar="FILE", help="where the page goes; by default it is printed")
    parser.add_argument("--tag", default=code_version(), help="version of the code")
    options = parser.parse_args(arguments)
    ledger = Ledger(options.ledger, "next_value")
    asked = questions(options.pairs, options.rigs, options.random)
    done = ledger.finished(options.tag, "")
    left = [one for one in asked if one.name not in done]
    try:
        if left:
            fight(left, options.workers, ledger, options.tag, options.cluster)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here", file=sys.stderr)
        return 130
    except HjcampError as error:
        print(f"{error}; the same command goes on from here", file=sys.stderr)
        return 1
    known = {line["name"]: line for line in ledger.lines(options.tag)}
    text = page([(one, known[one.name]) for one in asked], options.tag)
    if options.page is None:
        print(text, end="")
    else:
        write_whole(options.page, text)
    return 0


def fight(left: Sequence[Question], workers: int, ledger: Ledger, tag: str, cluster: str | None = None) -> None:
    """Fight duels in processes of their own, or on a cluster, and keep each as it ends."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
    columns = (TextColumn("{task.description:<44}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, TimeRemainingColumn(), speed_estimate_period=3600, console=Console(stderr=True)) as progress:
        task = progress.add_task("duels", total=len(left))
        calls = [(one,) for one in left]
        for line in there("benchmarks.next_value.running", "outcome", calls, cluster) if cluster else outcomes(left, workers):
            ledger.add({"plan": ledger.plan, "tag": tag, "effort": "", **line})
            progress.update(task, advance=1, description=line["name"][:44])
            if not progress.console.is_terminal:
                progress.console.print(f"{line['name']}: {line['ours']}", markup=False, highlight=False)


def outcomes(left: Sequence[Question], workers: int) -> Iterator[dict[str, Any]]:
    """Yield how each duel ends, from processes of their own."""
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), initializer=alone) as pool:
        try:
            for ended in as_completed([pool.submit(outcome, one) for one in left]):
                yield ended.result()
        except BaseException:
            stop(pool)
            raise


if __name__ == "__main__":
    sys.exit(main())
