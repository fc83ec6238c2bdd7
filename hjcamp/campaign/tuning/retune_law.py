"""The parameters of a plant's controller, sought on simulated tests: a seeded search for the smallest mean tracking error."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends import plant_simulation
from hjcamp.controllers.fit import controlled_field
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.plan import Condition, PlannedTest

Array = NDArray[np.float64]
FACTOR = 3.0  # a parameter is sought between a third and three times where it starts
GENERATIONS, MEMBERS = 12, 6


@dataclass(frozen=True)
class RetunedLaw:
    """Parameters before and after, the mean root mean square error (SI) of the tests with both, and what the search was."""

    start: Mapping[str, float]
    found: Mapping[str, float]
    before: float
    after: float
    evaluations: int
    conditions: tuple[str, ...]


def tracking_error(config: Mapping[str, Any], seed: int) -> float:
    """Return the root mean square error (SI) of what is controlled over the command phase; infinite where the loop fails."""
    try:
        prepared = plant_simulation.prepare(config, seed)
        recorded = prepared.simulator.run_loop(prepared.start, prepared.p, prepared.test)
    except HjcampError:
        return math.inf
    plant, test = prepared.simulator.composition.plant, prepared.test
    fields = plant_simulation.measured_fields(plant)
    shown = prepared.simulator.composition.measured[fields.index(controlled_field(plant))]
    error = (test.reference[:, 0] - recorded[f"reading.{shown}"])[test.first : test.last]
    return float(np.sqrt(np.mean(error**2)))


def retune_law(conditions: Sequence[Condition], tests: Sequence[PlannedTest], seed: int) -> RetunedLaw:
    """Return the ``tuned`` parameters of the law that ``conditions`` share with the smallest mean error over their tests.

    Differential evolution in the logarithms from the values of the first condition, each between a third and three times that
    (what is 0 stays so), then a simplex. Tests are simulated with their own seeds and scatter. The same ``seed`` gives the same values.
    Raises ``UsageError`` for conditions with different laws, and for a law without anything to tune.
    """
    from scipy.optimize import differential_evolution, minimize

    configs = {one.name: one.config for one in conditions}
    law, _ = plant_simulation.law_of(conditions[0].config)
    if any(plant_simulation.law_of(one.config)[0] is not law for one in conditions):
        raise UsageError("the conditions have different controllers; give controller=NAME, or vary it in the campaign")
    if not law.tuned:
        raise UsageError(f"controller {law.name} has nothing to tune; its class says what with tuned = (...)")
    given = plant_simulation.law_values(conditions[0].config, law)
    start = {name: given[name] for name in law.tuned if given[name]}
    if not start:
        raise UsageError(f"controller {law.name}: {', '.join(law.tuned)} are 0; a search in factors begins at other values")
    base = np.array(list(start.values()))
    runs = [(configs[test.condition], test.seed) for test in tests if test.condition in configs]
    limit, count = math.log(FACTOR), 0

    def cost(found: Mapping[str, float]) -> float:
        errors = []
        for config, own in runs:
            asked = {**copy.copy(config), "controller": {**config["controller"], **found}}
            errors.append(tracking_error(asked, own))
        return float(np.mean(errors))

    def of_logarithms(logarithms: Array) -> float:
        nonlocal count
        count += 1
        return min(cost(named(logarithms)), 1e9)

    def named(logarithms: Array) -> dict[str, float]:
        sizes = base * np.exp(np.clip(logarithms, -limit, limit))
        low, high = np.array([law.parameters[name].bounds for name in start]).T
        return {name: float(size) for name, size in zip(start, np.clip(sizes, low, high), strict=True)}

    before = cost(start)
    best = differential_evolution(
        of_logarithms, [(-limit, limit)] * len(base), x0=np.zeros(len(base)), rng=np.random.default_rng(seed),
        maxiter=GENERATIONS, popsize=MEMBERS, polish=False, tol=0.0,
    )  # fmt: skip
    fine = minimize(of_logarithms, best.x, method="Nelder-Mead", options={"maxfev": 60, "xatol": 1e-2, "fatol": 1e-6})
    found = named(fine.x if fine.fun < best.fun else best.x)
    rounded = {name: float(f"{value:.3g}") for name, value in found.items()}
    return RetunedLaw(start, rounded, before, cost(rounded), count, tuple(configs))
