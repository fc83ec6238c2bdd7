"""Try a test of the menu in simulation: a rival as the whole truth, in closed or open loop, with the rig's scatter."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, as_override
from hjcamp.controllers import find_controller
from hjcamp.errors import HjcampError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence, TestEvidence, prepare_test
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import Hardware
from hjcamp.plants.pump_joint.diagnosis.measured.repetition import RepetitionScatter
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.loop import JointSimulator
from hjcamp.plants.pump_joint.simulation import log_columns, model_values, prepare
from hjcamp.records.log import TestLog
from hjcamp.trajectories import build_trajectory

Array = NDArray[np.float64]
SPARE = 0.9
RIG_PRESSURE = 0.65


@functools.lru_cache(maxsize=8)
def _simulator(effects: tuple[Any, ...], controller: Any) -> JointSimulator:
    return JointSimulator(Composition(PumpJoint, effects, gated=True), controller=controller)


@dataclass(frozen=True)
class Trial:
    """A test of the menu on the user's hardware: its resolved configuration and its length in s."""

    choice: Choice
    config: Mapping[str, Any]
    hardware: Hardware
    seconds: float


class Bench:
    """The simulated stand-in of the rig: hardware by ``overrides``, scatter as measured where there are logs.

    ``highest_mpa`` is the highest pressure that a proposed test may reach.
    """

    def __init__(
        self,
        effects: Sequence[Any],
        overrides: Sequence[str] = (),
        scatter: RepetitionScatter | None = None,
        highest_mpa: float | None = None,
    ) -> None:
        self.effects = tuple(effects)
        self.overrides = tuple(overrides)
        self.scatter = scatter
        self.composer = Composer()
        config = self.composer.compose(self.overrides).config
        check_configuration(config)
        self.config = config
        self.values = _hardware(config).values
        self._views = Views(Evidence(()), self.effects)
        self.highest = highest_mpa or float(config["rig"].get("limits", {}).get("pressure_high_mpa", RIG_PRESSURE))
        self.arm_limit = float(config["rig"].get("limits", {}).get("arm_deg", 170.0))

    def trial(self, choice: Choice) -> Trial | None:
        """Return the test on this hardware; None where the pump would have to be faster than it is."""
        lines = [as_override(key, value) for key, value in choice.settings.items()]
        config = self.composer.compose([*self.overrides, *lines, *self._scatter_lines()]).config
        trajectory = build_trajectory(config["trajectory"])
        time = np.arange(round(trajectory.duration * 1e3)) * 1e-3
        speed = float(np.max(np.abs(trajectory.reference(time)[1])))
        pump = config["pump"]
        needed = speed * config["controller"]["scale"] / (2 * np.pi) * pump["lead_mm_per_rev"]
        if needed > SPARE * pump["speed_limit_mm_per_s"]:
            return None
        return Trial(choice, config, _hardware(config), float(trajectory.duration))

    def _scatter_lines(self) -> list[str]:
        if self.scatter is None:
            return []
        given = {
            "rig.scatter.friction_between": self.scatter.friction_between,
            "rig.scatter.friction_within": self.scatter.friction_within,
            "rig.scatter.friction_correlation_s": self.scatter.correlation,
            "rig.sensors.pressure_noise_mpa": self.scatter.pressure_noise * 1e-6,
        }
        return [as_override(key, float(value)) for key, value in given.items()]

    def columns(self, trial: Trial, candidate: Candidate, seed: int) -> dict[str, Array] | None:
        """Return the columns of the log of one repetition; None where a limit of the rig is passed or it fails."""
        law: Any = find_controller(trial.config["controller"]["name"])
        prepared = prepare(trial.config, seed)
        simulator = _simulator(self.effects, law)
        p = self._views.vector(simulator, candidate, trial.hardware)
        try:
            columns = log_columns(simulator.run(prepared.start, p, prepared.test))
        except HjcampError:
            return None
        moving = columns["phase"] == 3.0
        highest = max(columns[name][moving].max() for name in ("pressure1_mpa", "pressure2_mpa"))
        if highest > self.highest or np.abs(columns["arm_deg"][moving]).max() > self.arm_limit:
            return None
        return columns

    def evidence(self, trial: Trial, candidate: Candidate, seeds: Sequence[int]) -> list[TestEvidence] | None:
        """Return the repetitions of one test, prepared as logs are; None where any of them cannot be run."""
        tests = []
        metadata = {**_names(trial.config), "condition": trial.choice.name}
        for seed in seeds:
            columns = self.columns(trial, candidate, seed)
            if columns is None:
                return None
            tests.append(replace(prepare_test(TestLog(columns, metadata)), hardware=trial.hardware))
        return tests


def _names(config: Mapping[str, Any]) -> dict[str, str]:
    return {group: str(config[group]["name"]) for group in (*PumpJoint.rig, *PumpJoint.setups)}


def _hardware(config: Mapping[str, Any]) -> Hardware:
    """Return the hardware of a configuration with every override of the user, not only the named choices."""
    values, effects = model_values(config)
    own = {name: given for name, given in effects.items() if name in ("payload_inertia", "gravity_load")}
    return Hardware(tuple(_names(config).items()), values, own)
