"""The critical gain and period of the configured loop, found on the simulated rig with steps (thesis 5.2.1)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.simulation import log_columns, prepare
from hjcamp.plants.pump_joint.studies.ziegler_nichols import CriticalPoint

SIDES = ("positive", "negative")
QUIET = (
    "controller.dither.amplitude_v=0",
    "controller.derivative_samples=1",
    "rig.scatter.friction_between=0",
    "rig.scatter.friction_within=0",
    "rig.scatter.initial_pressure_mpa=0",
    "rig.sensors.pressure_noise_mpa=0",
)
DURATION_S = 2.0
LOWEST_GAIN, HIGHEST_GAIN = 0.02, 50.0
PRECISION = 0.005
COUNTS = 3.0  # an oscillation smaller than this many encoder counts is the sensor's


def critical_point(composer: Composer, overrides: Sequence[str], step_deg: float) -> CriticalPoint:
    """Return the critical point for a step of ``step_deg`` (negative: the other direction), to 0.5 % of the gain.

    Integral, derivative and dither are off and nothing scatters. Friction lets a small step come to rest at gains where
    a larger one goes on oscillating, so the answer belongs to the step. Source: thesis 5.2.1.
    """
    low, high = LOWEST_GAIN, HIGHEST_GAIN
    for end, wanted in ((low, False), (high, True)):
        if (oscillation(composer, overrides, step_deg, end) is not None) != wanted:
            state = "does not oscillate at" if wanted else "oscillates even at"
            raise HjcampError(f"a step of {step_deg:g} deg {state} a gain of {end:g}: no critical gain in reach")
    while high / low > 1 + PRECISION:
        middle = math.sqrt(low * high)
        if oscillation(composer, overrides, step_deg, middle) is None:
            low = middle
        else:
            high = middle
    period = oscillation(composer, overrides, step_deg, high)
    assert period is not None
    return CriticalPoint(high, period)


def oscillation(composer: Composer, overrides: Sequence[str], step_deg: float, gain: float) -> float | None:
    """Return the period (s) of the oscillation that lasts after a step at this proportional gain, None without one."""
    gains = [f"controller.{side}.{name}={gain if name == 'kp' else 0.0!r}" for side in SIDES for name in ("kp", "ki", "kd")]
    step = ["trajectory=hold", f"trajectory.angle_deg={step_deg!r}", f"trajectory.duration={DURATION_S!r}"]
    config = composer.compose([*overrides, "controller=pid", *step, *QUIET, *gains]).config
    prepared = prepare(config, 1)
    columns = log_columns(prepared.simulator.run(prepared.start, prepared.p, prepared.test))
    arm = columns["arm_deg"][columns["phase"] == 3.0]
    return lasting_period(arm, COUNTS * 360.0 / config["rig"]["sensors"]["encoder_counts_per_turn"])


def lasting_period(arm: NDArray[np.float64], smallest: float, period: float = 1e-3) -> float | None:
    """Return the period (s) of the residual in the second half of ``arm`` (n,), None where it is small or dies away."""
    quarters = [np.ptp(part) for part in np.array_split(arm, 4)]
    if quarters[3] < smallest or quarters[3] < 0.8 * quarters[2]:
        return None
    late = arm[len(arm) // 2 :] - np.mean(arm[len(arm) // 2 :])
    upward = np.flatnonzero((late[:-1] < 0) & (late[1:] >= 0))
    return float(np.mean(np.diff(upward)) * period) if len(upward) > 2 else None
