"""Replay of whole tests, driven by the measured pump: error of every channel, and the floor that repetitions set."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.evidence import DEGREE, Evidence
from hjcamp.discrepancy.views import Views
from hjcamp.errors import HjcampError

Array = NDArray[np.float64]
CHANNELS = ("arm_deg", "pressure1_mpa", "pressure2_mpa", "pump_deg")
SCALES = np.array([1 / DEGREE, 1e-6, 1e-6])


@dataclass(frozen=True)
class ChannelError:
    """Error of one channel in its own unit: rms, the floor (None without repetitions), and r2."""

    rms: float
    floor: float | None
    r2: float | None

    @property
    def ratio(self) -> float | None:
        """Error over floor."""
        return None if not self.floor else self.rms / self.floor


def floor_of(residual: Sequence[Array], conditions: Iterable[Sequence[int]]) -> float | None:
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
    whose log lacks one of them has none.
    """

    name: str
    evidence: Evidence
    predicted: Array
    measured: Array
    pump: dict[int, Array]
    pump_measured: dict[int, Array]

    @cached_property
    def errors(self) -> dict[str, ChannelError | None]:
        """The error of every channel; None where no log tells."""
        parts = list(zip(self.evidence.edges[:-1], self.evidence.edges[1:], strict=True))
        found: dict[str, ChannelError | None] = {}
        for index, name in enumerate(CHANNELS[:3]):
            residual = [self.predicted[a:b, index] - self.measured[a:b, index] for a, b in parts]
            measured = [self.measured[a:b, index] for a, b in parts]
            found[name] = channel_error(residual, measured, self.evidence.conditions.values())
        order = {test: place for place, test in enumerate(self.pump)}
        shared = [[order[i] for i in tests if i in order] for tests in self.evidence.conditions.values()]
        found[CHANNELS[3]] = (
            channel_error(list(self.pump.values()), list(self.pump_measured.values()), shared) if self.pump else None
        )
        return found


def channel_error(
    residual: Sequence[Array], measured: Sequence[Array], conditions: Iterable[Sequence[int]]
) -> ChannelError:
    """Return rms, floor and r2 of one channel from its residuals and measurements, test by test."""
    square = sum(float((one**2).sum()) for one in residual)
    spread = sum(float(((one - one.mean()) ** 2).sum()) for one in measured)
    rms = float(np.sqrt(square / sum(len(one) for one in residual)))
    return ChannelError(rms, floor_of(residual, conditions), 1.0 - square / spread if spread > 0 else None)


def replay(views: Views, name: str, candidate: Candidate) -> Replay:
    """Return the replay of one model over whole tests; a model that runs away is refused."""
    evidence = views.evidence
    joint, _ = views.readings(candidate, windows=False)
    if not np.isfinite(joint).all():
        place = int(evidence.of_test[int(np.flatnonzero(~np.isfinite(joint).all(axis=1))[0])])
        raise HjcampError(f"model {name} runs away on {evidence.tests[place].name}: its parameters make it unstable")
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
    return Replay(name, evidence, joint[:, :3] * SCALES, measured * SCALES, pump, seen)
