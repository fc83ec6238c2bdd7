"""The rig in memory: every test of a table's conditions, simulated with any base parameter, effect or factor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers import find_controller
from hjcamp.effects import load_effects
from hjcamp.errors import HjcampError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.simulator import PERIOD
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.controllers.ffwd_pid import FfwdPid
from hjcamp.plants.pump_joint.controllers.pid import Pid
from hjcamp.plants.pump_joint.factors import FACTORS, changed_loop, changed_values
from hjcamp.plants.pump_joint.loop import JointSimulator
from hjcamp.plants.pump_joint.procedure import CONTROL
from hjcamp.plants.pump_joint.simulation import DEGREE, PreparedTest, prepare
from hjcamp.records.plan import Condition, seed_of
from hjcamp.report.runs.indicators import INDICATORS, error_indicators

Array = NDArray[np.float64]
Settings = Mapping[str, float]
ARM = next(one for one in PumpJoint.channels if one.field == "arm_deg")
#: Degrees that a test counts which does not come to its end.
LOST = 200.0


@dataclass(frozen=True)
class Place:
    """One test: its trajectory, its law, what it takes to run it, and its effects, which are known and not fitted."""

    trajectory: str
    law: Any
    prepared: PreparedTest
    effects: frozenset[str]


@lru_cache(maxsize=4)
def gated(law: Any) -> JointSimulator:
    """Return the closed loop with the whole effect library behind gates, compiled once for each law.

    A PID law is the same law with a feedforward of zero, so both share a kernel.
    """
    library = load_effects()
    effects = tuple(library[name] for name in sorted(library))
    return JointSimulator(Composition(PumpJoint, effects, gated=True), controller=FfwdPid if law is Pid else law)


@dataclass(frozen=True)
class Rig:
    """The tests of each condition, simulated with the same random numbers for every setting."""

    tests: Sequence[Sequence[Place]]

    @classmethod
    def planned(
        cls, conditions: Sequence[Condition], repetitions: int, seed: int, report: Callable[[float], None] | None = None
    ) -> Rig:
        """Prepare the tests with the seeds that ``hjcamp run`` gives them."""
        tests = []
        for number, condition in enumerate(conditions):
            if report:
                report(number / len(conditions))
            law = find_controller(condition.config["controller"]["name"])
            known = frozenset({**(condition.config["model"].get("effects") or {}), **(condition.config.get("effects") or {})})
            trajectory = str(condition.config["trajectory"]["name"])
            tests.append(
                [
                    Place(trajectory, law, prepare(condition.config, seed_of(seed, condition.name, number)), known)
                    for number in range(1, repetitions + 1)
                ]
            )
        return cls(tests)

    def repeated(self, count: int) -> Rig:
        """Return the first ``count`` repetitions of each condition."""
        return Rig([tests[:count] for tests in self.tests])

    @property
    def known(self) -> frozenset[str]:
        """The effects that some test has anyway, such as its payload."""
        return frozenset(name for tests in self.tests for place in tests for name in place.effects)

    def indicators(self, settings: Settings) -> Array:
        """Return (conditions, repetitions, indicators) in degrees; undefined steady state errors are NaN."""
        return np.array([[run_one(place, settings) for place in tests] for tests in self.tests])


def run_one(place: Place, settings: Settings) -> list[float]:
    """Return the indicators of one test in degrees; a test that does not come to its end counts as lost."""
    simulator = gated(place.law)
    factors = {name: value for name, value in settings.items() if name in FACTORS}
    test = changed_loop(place.prepared.test, place.law, factors)
    p = vector_of(place, settings, factors)
    values = dict(zip(simulator.composition.parameters, p, strict=True))
    try:
        run = simulator.run(place.prepared.start, p, replace(test, delay=values["pump_delay"]))
    except HjcampError:
        return [LOST] * 3 + [LOST if place.trajectory.startswith("cycloid") else np.nan]
    command = run["phase"] == float(CONTROL)
    columns = {
        "time_s": np.arange(int(command.sum())) * PERIOD,
        "reference_deg": run["reference"][command] / DEGREE,
        "arm_deg": run["arm_deg"][command] * ARM.log_scale,
    }
    row = error_indicators(columns, place.trajectory)
    return [np.nan if row[name] is None else float(row[name]) for name in INDICATORS]


def vector_of(place: Place, settings: Settings, factors: Settings) -> Array:
    """Return the parameter vector of a test: its own hardware and payload, then the settings."""
    prepared, simulator = place.prepared, gated(place.law)
    values = dict(zip(prepared.simulator.composition.parameters, map(float, prepared.p), strict=True))
    values |= {name: value for name, value in settings.items() if name not in FACTORS}
    values = changed_values(values, factors)
    present = {name.split(".")[0] for name in values if "." in name}
    return simulator.vector(values | {f"gate.{effect}": 1.0 for effect in present})
