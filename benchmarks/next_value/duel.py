"""Two rivals on one rig of the truth plant: how many tests set them apart, in a given order or as `hjcamp next` proposes."""

from __future__ import annotations

from typing import Any

import numpy as np
from truth.pump_joint.case import build_case, simulate_test
from truth.pump_joint.menu import Condition, asked, sine
from truth.pump_joint.simulate import COLUMNS

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice
from hjcamp.plants.pump_joint.diagnosis.design.propose import REPETITIONS, propose
from hjcamp.plants.pump_joint.diagnosis.design.rivals import Rival
from hjcamp.plants.pump_joint.diagnosis.design.trials import Bench
from hjcamp.plants.pump_joint.diagnosis.fitting.calibrate import calibrate
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fitter
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence, prepare
from hjcamp.plants.pump_joint.diagnosis.measured.repetition import scatter_of
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.screening.screening import fit_effect, rival_weights, screen, unknowns_of
from hjcamp.records.log import TestLog

MOST = 16
BATCH = 2
APART = 0.95
STEPS = 4
FIRST = Condition("sine_first", "sine_0p5hz", lambda: sine(0.5, 4), 60, 0.40)


def logs_of(effect: str, strength: str, seed: int, condition: Condition, first_test: int, repetitions: int) -> list[TestLog]:
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
