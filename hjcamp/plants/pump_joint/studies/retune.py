"""Gains tuned again for the conditions of a campaign: a seeded search on the simulated rig, without scatter or on given draws."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers import find_controller
from hjcamp.controllers.controller import Controller
from hjcamp.errors import HjcampError, UsageError
from hjcamp.model.run.simulator import Propagators
from hjcamp.plants.pump_joint.simulation import PreparedTest, control_values, log_columns, prepare
from hjcamp.records.plan import Condition

Array = NDArray[np.float64]
Gains = Mapping[str, Mapping[str, float]]
GAINS = ("kp", "ki", "kd")
SIDES = ("positive", "negative")
FACTOR = 3.0  # a gain is sought between a third and three times where it starts
GENERATIONS, MEMBERS = 12, 6
UNSTABLE_DEG = 1000.0
QUIET = {"friction_between": 0.0, "friction_within": 0.0, "initial_pressure_mpa": 0.0}


@dataclass(frozen=True)
class Retuned:
    """Gains before and after, the mean RMSE1 (deg) of the tests with both, and what the search was."""

    start: Gains
    gains: Gains
    before: float
    after: float
    evaluations: int
    conditions: tuple[str, ...]


@dataclass(frozen=True)
class _Test:
    """One test made ready once; only the control parameters change from call to call."""

    config: dict[str, Any]
    law: type[Controller]
    prepared: PreparedTest
    propagators: Propagators
    direction: float

    def rmse1(self, gains: Gains) -> float:
        """Return the RMSE1 (deg) with these gains; 1000 where the loop does not get through the test."""
        config = {"controller": {**self.config["controller"], **gains}}
        control = self.law.vector(control_values(config, self.law, self.direction))
        prepared = self.prepared
        test = replace(prepared.test, control=control)
        try:
            columns = log_columns(prepared.simulator.run(prepared.start, prepared.p, test, self.propagators))
        except HjcampError:
            return UNSTABLE_DEG
        moving = columns["phase"] == 3.0
        return float(np.sqrt(np.mean((columns["reference_deg"] - columns["arm_deg"])[moving] ** 2)))


def retune(
    conditions: Sequence[Condition],
    start: Gains,
    seed: int,
    notice: Callable[[float], None] = lambda best: None,
    draws: Sequence[int] = (),
) -> Retuned:
    """Return the gains with the smallest mean RMSE1 over ``conditions``, which are to share one gain set.

    Differential evolution in the logarithms of the six gains from ``start``, each between a third and three times its
    start; then a simplex from the best, rounded to three digits; ``start`` itself where that is worse. The same ``seed``
    gives the same gains. Thesis 5.6 retunes by hand and prints no gains; RMSE1 of 5.2.5.1 is the criterion here. Each
    condition is one test without scatter, or, with ``draws``, one with scatter for each of these seeds: gains that fit
    one course of sticking and slipping alone are not found then.
    """
    from scipy.optimize import differential_evolution, minimize

    if draws:
        tests = [_made_ready(condition, draw, {}) for condition in conditions for draw in draws]
    else:
        tests = [_made_ready(condition, seed, QUIET) for condition in conditions]
    base = np.array([start[side][name] for side in SIDES for name in GAINS])
    count = 0

    def cost(logarithms: Array) -> float:
        nonlocal count
        count += 1
        gains = _as_gains(base * np.exp(np.clip(logarithms, *limits)))
        return float(np.mean([test.rmse1(gains) for test in tests]))

    limits = (-math.log(FACTOR), math.log(FACTOR))
    # What stops a test (its procedure, say) is told as it is.
    for test in tests:
        test.prepared.simulator.run(test.prepared.start, test.prepared.p, test.prepared.test, test.propagators)
    before = cost(np.zeros(len(base)))
    best = differential_evolution(
        cost, [limits] * len(base), x0=np.zeros(len(base)), rng=np.random.default_rng(seed), maxiter=GENERATIONS,
        popsize=MEMBERS, polish=False, tol=0.0, callback=lambda x, convergence: notice(cost(x)),
    )  # fmt: skip
    fine = minimize(cost, best.x, method="Nelder-Mead", options={"maxfev": 150, "xatol": 1e-2, "fatol": 1e-4})
    found = _as_gains(base * np.exp(np.clip(fine.x if fine.fun < best.fun else best.x, *limits)))
    rounded = {side: {name: float(f"{value:.3g}") for name, value in group.items()} for side, group in found.items()}
    after = float(np.mean([test.rmse1(rounded) for test in tests]))
    if after > before:  # rounding left a narrow minimum
        rounded, after = {side: dict(start[side]) for side in SIDES}, before
    return Retuned(start, rounded, before, after, count, tuple(condition.name for condition in conditions))


def gains_of(config: Mapping[str, Any], where: str) -> dict[str, dict[str, float]]:
    """Return the gain set of a resolved configuration; raises ``UsageError`` where its controller has none."""
    controller = config["controller"]
    if not all(set(GAINS) <= set(controller.get(side) or {}) for side in SIDES):
        raise UsageError(f"{where}: controller '{controller.get('name')}' has no gains to tune")
    return {side: {name: float(controller[side][name]) for name in GAINS} for side in SIDES}


def _as_gains(values: Array) -> dict[str, dict[str, float]]:
    pairs = iter(values)
    return {side: {name: float(next(pairs)) for name in GAINS} for side in SIDES}


def _made_ready(condition: Condition, seed: int, scatter: Mapping[str, float]) -> _Test:
    config = copy.deepcopy(condition.config)
    config["rig"]["scatter"].update(scatter)
    prepared = prepare(config, seed)
    start = prepared.simulator.begin(prepared.start, prepared.p)
    law = find_controller(config["controller"]["name"])
    names = list(law.parameters)
    direction = float(prepared.test.control[names.index("first_direction")]) if "first_direction" in names else 1.0
    return _Test(config, law, prepared, prepared.simulator.propagators(start, prepared.p), direction)
