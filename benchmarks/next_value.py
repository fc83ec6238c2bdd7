"""How many tests set two rivals apart: in the order that `hjcamp next` proposes, and in random order.

    python benchmarks/next_value.py [--random 4] [--pairs 8] > docs/next_value.md

For each pair the truth plant of the tests, which shares no code with the model, hides the first effect in a rig of its
own, at medium and at weak strength. The first tests are one condition with three repetitions. Both rivals are fitted to
them; then one test after the other (one repetition each) is run on the truth plant, both rivals are refitted on all tests,
and weighed as a diagnosis weighs them. They are apart when the true one has 95 % of the weight. Proposals are made anew
after every two tests. Pairs that the first tests set apart, and pairs that no order sets apart (a pressure offset is a
friction asymmetry to every test), say nothing of the order and are left out of the means.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from truth.case import build_case, simulate_test
from truth.menu import Condition, asked, sine
from truth.simulate import COLUMNS

from hjcamp.discrepancy.baseline import calibrate
from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.evidence import Evidence, prepare
from hjcamp.discrepancy.features import Features
from hjcamp.discrepancy.fit import Fitter
from hjcamp.discrepancy.next_menu import Choice, menu
from hjcamp.discrepancy.next_rivals import Rival
from hjcamp.discrepancy.next_tests import REPETITIONS, propose
from hjcamp.discrepancy.next_trials import Bench
from hjcamp.discrepancy.repetition import scatter_of
from hjcamp.discrepancy.search import fit_effect, rival_weights, screen, unknowns_of
from hjcamp.discrepancy.views import Views
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

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
MOST = 8
BATCH = 2
APART = 0.95
STEPS = 4
FIRST = Condition("sine_first", "sine_0p5hz", lambda: sine(0.5, 4), 60, 0.40)


def logs_of(
    effect: str, strength: str, seed: int, condition: Condition, first_test: int, repetitions: int
) -> list[TestLog]:
    """Return the repetitions of one condition on the truth plant, as logs."""
    case = build_case([effect], strength, seed, conditions=[condition])
    object.__setattr__(case, "first_test", first_test)
    found = []
    for number in range(repetitions):
        rows = simulate_test(case, 0, number)
        metadata = {"condition": condition.name, "pump": "pump2", "amplifier": "high_gain", "tubing": "ldpe_300mm"}
        columns = {name: np.ascontiguousarray(rows[:, index]) for index, name in enumerate(COLUMNS)}
        found.append(TestLog(columns, metadata))
    return found


class Duel:
    """Two rivals on one rig of the truth plant."""

    def __init__(
        self, names: tuple[str, str], strength: str, seed: int, effects: tuple[Any, ...], choices: list[Choice]
    ) -> None:
        self.names, self.strength, self.seed, self.effects, self.choices = names, strength, seed, effects, choices
        self.logs: dict[str, list[TestLog]] = {}
        self.first = logs_of(names[0], strength, seed, FIRST, 0, REPETITIONS)
        evidence = prepare(self.first)
        views = Views(evidence, effects)
        base, self.fitter = calibrate(views, Features(evidence))
        screening = screen(self.fitter, base, [effect for effect in effects if effect.name in names])
        self.base = base.candidate
        self.start: dict[str, Candidate] = {}
        for effect in effects:
            if effect.name in names:
                if effect.name in screening.ranked:
                    self.start[effect.name] = fit_effect(self.fitter, screening, effect, effects, STEPS).candidate
                else:
                    self.start[effect.name] = self.base.with_effect(effect.name, effect.defaults())

    def tests(self, choice: Choice) -> list[TestLog]:
        """Return the logs of one test of the menu; they are made once."""
        if choice.name not in self.logs:
            number = 1000 + [one.name for one in self.choices].index(choice.name)
            self.logs[choice.name] = logs_of(
                self.names[0], self.strength, self.seed, asked(choice.name, choice.settings), number, 1
            )
        return self.logs[choice.name]

    def refit(self, logs: list[TestLog], candidates: dict[str, Candidate]) -> tuple[Fitter, float]:
        """Return the fitter of all these tests and the weight of the true rival; the candidates are refitted in place."""
        evidence: Evidence = prepare(logs)
        fitter = Fitter(Views(evidence, self.effects), Features(evidence), self.fitter.least)
        fits = {}
        for name, candidate in candidates.items():
            fits[name] = fitter.fit(candidate, unknowns_of(candidate, self.effects), steps=STEPS, enough=0.3)
            candidates[name] = fits[name].candidate
        return fitter, rival_weights(fits, fitter.least, self.effects)[self.names[0]]

    def needed(self, order: list[Choice]) -> int:
        """Return after how many tests in this order the rivals are apart; with an empty order what is proposed is run."""
        logs, candidates, names = list(self.first), dict(self.start), list[str]()
        fitter, left = self.fitter, list(order)
        for count in range(1, MOST + 1):
            if not left:
                left = self.propose(fitter, candidates, names)
            choice = left.pop(0)
            names.append(choice.name)
            logs = logs + self.tests(choice)
            fitter, weight = self.refit(logs, candidates)
            if weight > APART:
                return count
        return MOST + 1

    def propose(self, fitter: Fitter, candidates: dict[str, Candidate], run: list[str]) -> list[Choice]:
        """Return the next tests that are proposed after those that have been run; no test is run twice."""
        rivals = [Rival((name,), candidate, 0.5) for name, candidate in candidates.items()]
        scatter = scatter_of(self.fitter.views.evidence, dict(self.base.base))
        bench = Bench(self.effects, scatter=scatter, highest_mpa=1.3)
        left = [choice for choice in self.choices if choice.name not in run]
        proposal = propose(rivals, bench, tests=BATCH, repetitions=1, measured=fitter, choices=left)
        chosen = [one.trial.choice for one in proposal.tests]
        return chosen or left[:1]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--random", type=int, default=4, help="random orders for each pair")
    parser.add_argument("--pairs", type=int, default=len(PAIRS))
    options = parser.parse_args()
    effects = tuple(load_effects().values())
    choices = [one for one in menu() if not {"payload", "orientation"} & set(one.settings)]
    began, ours, theirs = time.perf_counter(), [], []
    print("# Tests needed to set two rivals apart\n")
    print("Made by `python benchmarks/next_value.py`; its head says how. A test is one repetition of one condition;")
    print(f"at most {MOST} are run, {MOST + 1} means not apart by then.\n")
    print("| truth | strength | rival | proposed order | random order (each) |\n|---|---|---|---|---|", flush=True)
    duels = [(strength, names) for strength in STRENGTHS for names in PAIRS[: options.pairs]]
    for number, (strength, names) in enumerate(duels):
        duel = Duel(names, strength, 300 + number, effects, choices)
        _, weight = duel.refit(duel.first, dict(duel.start))
        row = f"| {names[0]} | {strength} | {names[1]} |"
        if weight > APART:
            print(f"{row} apart from the start | |", flush=True)
            continue
        mine = duel.needed([])
        random = np.random.default_rng([7, number])
        orders = [random.permutation(len(choices))[:MOST] for _ in range(options.random)]
        others = [duel.needed([choices[k] for k in order]) for order in orders]
        if min(mine, *others) <= MOST:
            ours.append(mine)
            theirs += others
        print(f"{row} {mine} | {', '.join(map(str, others))} |", flush=True)
    ratio = np.mean(theirs) / np.mean(ours)
    print(
        f"\nMedian: {np.median(ours):g} proposed, {np.median(theirs):g} random; mean {np.mean(ours):.2f} and {np.mean(theirs):.2f},"
    )
    print(f"{ratio:.1f} times fewer, over {len(ours)} duels. {time.perf_counter() - began:.0f} s.")


if __name__ == "__main__":
    main()
