"""Replay of whole tests, driven by the measured pump: error of every channel, and the floor that repetitions set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import DEGREE, Evidence
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views

Array = NDArray[np.float64]
CHANNELS = ("arm_deg", "pressure1_mpa", "pressure2_mpa", "pump_deg")
Series = tuple[list[Array], list[Array]]
SCALES = np.array([1 / DEGREE, 1e-6, 1e-6])


@dataclass(frozen=True)
class ChannelError:
    """Error of one channel in its own unit: rms, the floor (None without repetitions), and r2."""

    rms: float
    noise_floor: float | None
    r2: float | None

    @property
    def ratio(self) -> float | None:
        """Error over floor."""
        return None if not self.noise_floor else self.rms / self.noise_floor


def noise_floor_of(residual: Sequence[Array], conditions: Iterable[Sequence[int]]) -> float | None:
    """Return what the repetitions of a condition do not share of one channel's residuals (tests of (n,)).

    The mean over conditions of the variance about the repetitions' mean, with R - 1 degrees of freedom; a test is cut
    to the shortest of its condition.
    """
    total, count = 0.0, 0
    for tests in conditions:
        if len(tests) < 2:
            continue
        shortest = min(len(residual[index]) for index in tests)
        block = np.stack([residual[index][:shortest] for index in tests])
        total += float(((block - block.mean(axis=0)) ** 2).sum()) * len(tests) / (len(tests) - 1)
        count += block.size
    return float(np.sqrt(total / count)) if count else None


@dataclass(frozen=True)
class Replay:
    """One model on all tests: predicted and measured arm (deg), pressures (MPa), each (n, 3) on the coarse clock.

    ``pump`` holds for each test the pump model driven by the command minus the measured pump (deg, 1 kHz); a test
    whose log lacks one of them has none. ``floors`` are those of all logs together.
    """

    name: str
    evidence: Evidence
    predicted: Array
    measured: Array
    pump: dict[int, Array]
    pump_measured: dict[int, Array]

    noise_floors: Mapping[str, float | None] | None = None

    @cached_property
    def errors(self) -> dict[str, ChannelError | None]:
        """The error of every channel over its floor; None where no log tells."""
        noise_floors = self.own_floors if self.noise_floors is None else self.noise_floors
        return {name: channel_error(*series, noise_floors.get(name)) for name, series in self.series.items()}

    @cached_property
    def series(self) -> dict[str, Series]:
        """What is left of every channel and what was measured, test by test."""
        parts = list(zip(self.evidence.edges[:-1], self.evidence.edges[1:], strict=True))
        found: dict[str, Series] = {}
        for index, name in enumerate(CHANNELS[:3]):
            measured = [self.measured[a:b, index] for a, b in parts]
            left = [self.predicted[a:b, index] for a, b in parts]
            found[name] = [one - seen for one, seen in zip(left, measured, strict=True)], measured
        found[CHANNELS[3]] = list(self.pump.values()), list(self.pump_measured.values())
        return found

    @cached_property
    def own_floors(self) -> dict[str, float | None]:
        """What the repetitions do not share of what this very model leaves."""
        order = {test: place for place, test in enumerate(self.pump)}
        conditions = list(self.evidence.conditions.values())
        shared = [[order[i] for i in tests if i in order] for tests in conditions]
        return {
            name: noise_floor_of(left, shared if name == CHANNELS[3] else conditions) for name, (left, _) in self.series.items()
        }


def channel_error(residual: Sequence[Array], measured: Sequence[Array], noise_floor: float | None) -> ChannelError | None:
    """Return rms, floor and r2 of one channel from its residuals and measurements, test by test; None without any."""
    if not residual:
        return None
    square = sum(float((one**2).sum()) for one in residual)
    spread = sum(float(((one - one.mean()) ** 2).sum()) for one in measured)
    rms = float(np.sqrt(square / sum(len(one) for one in residual)))
    return ChannelError(rms, noise_floor, 1.0 - square / spread if spread > 0 else None)


def replay(views: Views, name: str, candidate: Candidate, noise_floors: Mapping[str, float | None] | None = None) -> Replay:
    """Return the replay of one model over whole tests; raises HjcampError where the model runs away."""
    evidence = views.evidence
    joint = views.joint_readings(candidate, windows=False)
    if not np.isfinite(joint).all():
        place = int(evidence.of_test[int(np.flatnonzero(~np.isfinite(joint).all(axis=1))[0])])
        raise HjcampError(f"model {name} diverges on {evidence.tests[place].name}: its parameters make it unstable")
    measured = np.column_stack([evidence.joined(quantity) for quantity in ("arm", "pressure1", "pressure2")])
    pump, seen = {}, {}
    for index, test in enumerate(evidence.tests):
        columns = test.log.command_phase
        if test.command is None or "pump_deg" not in columns:
            continue
        hardware = replace(test.hardware, values={**test.hardware.values, **candidate.base})
        start = columns["pump_deg"][0] - test.command[0] / DEGREE
        seen[index] = columns["pump_deg"]
        pump[index] = hardware.pump_motion(test.command) / DEGREE + start - columns["pump_deg"]
    return Replay(name, evidence, joint[:, :3] * SCALES, measured * SCALES, pump, seen, noise_floors)
