"""How the repetitions of a rig differ, read off its own logs: friction between and within tests, pressures, noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD

Array = NDArray[np.float64]
MOVING = 3e-3


@dataclass(frozen=True)
class RepetitionScatter:
    """Relative standard deviations of friction, its correlation time (s), and the noise of a pressure sample (Pa)."""

    friction_between: float
    friction_within: float
    correlation: float
    pressure_noise: float
    pressure_drift: float = 0.0
    assumed: bool = False


def relative_friction(evidence: Evidence, base: dict[str, float]) -> list[Array]:
    """Return for each test the measured over the modelled sliding friction minus one (n,), NaN where the arm rests."""
    values = evidence.tests[0].hardware.values
    found = []
    for test in evidence.tests:
        push = (test.pressure1 - test.pressure2) * values["joint_area"]
        forward = test.velocity > 0
        coulomb = np.where(forward, base["coulomb_positive"], base["coulomb_negative"])
        viscous = np.where(forward, base["viscous_positive"], base["viscous_negative"])
        model = coulomb + viscous * np.abs(test.velocity)
        ratio = np.sign(test.velocity) * push / model - 1.0
        steady = np.abs(np.gradient(test.velocity, PERIOD)) < 1.0
        found.append(np.where((np.abs(test.velocity) > MOVING) & steady & (np.abs(ratio) < 0.6), ratio, np.nan))
    return found


def pressure_noise(evidence: Evidence) -> float:
    """Return the standard deviation of one pressure sample at 1 kHz (Pa), from its second differences."""
    found = []
    for test in evidence.tests:
        for name in ("pressure1_mpa", "pressure2_mpa"):
            second = np.diff(test.log.command_phase[name], 2)
            found.append(np.median(np.abs(second)) / 0.6745 / np.sqrt(6.0) * 1e6)
    return float(np.median(found))


def scatter_of(evidence: Evidence, base: dict[str, float]) -> RepetitionScatter:
    """Return the scatter of the rig; with single repetitions the usual values are assumed, and said so."""
    noise = pressure_noise(evidence)
    ratios = relative_friction(evidence, base)
    between, within, lags = [], [], []
    for tests in evidence.conditions.values():
        if len(tests) < 2:
            continue
        shortest = min(len(ratios[index]) for index in tests)
        block = np.stack([ratios[index][:shortest] for index in tests])
        shared = np.all(np.isfinite(block), axis=0)
        if shared.sum() < 40:
            continue
        difference = block[:, shared] - block[:, shared].mean(axis=0)
        factor = len(tests) / (len(tests) - 1)
        means = difference.mean(axis=1)
        between.append(np.mean(means**2) * factor)
        left = difference - means[:, None]
        within.append(np.mean(left**2) * factor)
        lags.append(_correlation(left))
    if not between:
        return RepetitionScatter(0.03, 0.03, 0.2, noise, assumed=True)
    return RepetitionScatter(
        float(np.clip(np.sqrt(np.mean(between)), 0.003, 0.2)),
        float(np.clip(np.sqrt(np.mean(within)), 0.003, 0.2)),
        float(np.clip(np.median(lags), 0.02, 1.0)),
        noise,
    )


def _correlation(left: Array) -> float:
    """Return the time (s) after which the autocorrelation of rows (tests, n) has fallen to 37 %."""
    power = np.mean(left**2)
    for lag in range(1, left.shape[1] // 2):
        if np.mean(left[:, lag:] * left[:, :-lag]) < np.exp(-1) * power:
            return lag * PERIOD
    return left.shape[1] // 2 * PERIOD
