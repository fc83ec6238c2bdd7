"""An encoder that does not count although it must: what a limit on an angle cannot see."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

SILENT_SAMPLES = 20
STILL_DEG = 1.0
SETTLED_SAMPLES = 100  # by then the drive has done what it was told
SETTLED = 0.2  # and a fifth of the limit is too far from it
PRELOAD_PHASE, RELEASE_PHASE = 0.0, 4.0
SOFTEST = 2.0  # the lines may take in twice the water that their stiffness says: air, warm tubing, another make
UNLOADED = 1.5  # without preload the pump may move further before the arm follows (up to 0.85 mm in the simulated campaigns)
SMALLEST_MM = 0.05  # of pump travel: less may be noise of the pressures
FIRST, SECOND = 1.0, -1.0


@dataclass(frozen=True)
class Coupling:
    """How far the arm turns where the lines are stiff (deg for 1 mm of pump travel), and what 1 MPa takes of that (mm).

    Water from the pump goes into the joint or stays in the line: A1 dx = A2 dy + dp / (dp/dV). Source: thesis 4.4.3.15.
    """

    deg_per_mm: float
    mm_per_mpa: float


def coupling_of(config: Mapping[str, Any]) -> Coupling:
    """Return the coupling of the configured pump, tubing and joint."""
    pump, joint = config["pump"]["bore_mm"] ** 2 * pi / 4, config["joint"]["bore_mm"] ** 2 * pi / 4
    turn = 360 / (pi * config["joint"]["pulley_pitch_diameter_mm"])
    return Coupling(pump / joint * turn, 1 / config["tubing"]["stiffness_mpa_per_mm3"] / pump)


class Silence:
    """Watches both encoders of one test; ``check`` returns which one is silent, or None.

    The arm may stand still while friction holds it: then the pressures rise by what the pump moved. What they do not
    account for, even in lines twice as soft as configured, must have turned the arm.
    """

    def __init__(self, pump_deg: float, arm_mm: float, arm_deg: float, coupling: Coupling) -> None:
        self._pump_deg, self._arm_mm, self._arm_deg, self._coupling = pump_deg, arm_mm, arm_deg, coupling
        self._motor: tuple[float, float] | None = None
        self._told = 0
        self._arm: tuple[float, float, float, float] | None = None
        self._loaded = False

    def check(
        self, sample: int, phase: float, command: float, travel: float, angle: float, one: float, two: float
    ) -> str | None:
        """Return what is silent; ``command`` and ``angle`` in deg, ``travel`` in mm, line pressures in MPa."""
        return self._check_motor(sample, phase, command, travel) or self._check_arm(phase, travel, angle, one, two)

    def _check_motor(self, sample: int, phase: float, command: float, travel: float) -> str | None:
        if self._motor is None or self._motor[0] != travel:
            self._motor, self._told = (travel, command), sample
            return None
        moved = abs(command - self._motor[1])
        if moved <= STILL_DEG:
            # A motor that was told nothing may stand for as long as it likes.
            self._told = sample
        silent = sample - self._told
        # A feedforward may jump; a motor that lives counts within 20 ms all the same.
        if moved > self._pump_deg and silent >= SILENT_SAMPLES:
            return f"the pump encoder is silent while its command moved by {self._pump_deg:g} deg"
        if moved > SETTLED * self._pump_deg and silent >= SETTLED_SAMPLES and phase > PRELOAD_PHASE:
            return f"the pump encoder is silent for {silent} ms, its command has moved by {moved:.0f} deg"
        return None

    def _check_arm(self, phase: float, travel: float, angle: float, one: float, two: float) -> str | None:
        loaded = PRELOAD_PHASE < phase < RELEASE_PHASE
        if phase <= PRELOAD_PHASE or self._arm is None or self._arm[0] != angle or loaded != self._loaded:
            self._arm, self._loaded = (angle, travel, one, two), loaded
            return None
        moved = travel - self._arm[1]
        farthest = self._arm_mm if loaded else UNLOADED * self._arm_mm
        if abs(moved) > farthest:
            return f"the arm encoder is silent while the pump moved by {farthest:g} mm"
        if loaded:
            side = FIRST if moved > 0 else SECOND
            held = max(side * (one - self._arm[2]), side * (self._arm[3] - two), 0.0)
            left = abs(moved) - SOFTEST * held * self._coupling.mm_per_mpa
            turned = left * self._coupling.deg_per_mm
            if turned > self._arm_deg and left > SMALLEST_MM:
                return f"the arm encoder is silent while pump and pressures say that the arm turned {turned:.0f} deg"
        return None
