"""Triangle wave about the start angle."""

from __future__ import annotations

import numpy as np

from hjcamp.trajectories.base import Array, Motion, Trajectory


class Triangle(Trajectory):
    r"""Constant speed to and fro between +A and -A, starting at 0 towards A.

    .. math:: |\dot\theta| = 4 A f

    One pass at each speed and direction: for friction against speed (compare thesis 4.5.1).
    """

    amplitude_deg: float
    frequency_hz: float

    def motion(self, time: Array) -> Motion:
        amplitude = np.radians(self.amplitude_deg)
        quarters = 4.0 * self.frequency_hz * time + 1.0  # quarter periods since the lower corner before time 0
        angle = amplitude * (1.0 - np.abs(np.mod(quarters, 4.0) - 2.0))
        speed = 4.0 * amplitude * self.frequency_hz
        # The tiny shift gives a sample on a corner the velocity after it, whatever its rounding.
        rising = np.mod(quarters + 1e-9, 4.0) < 2.0
        return angle, np.where(rising, speed, -speed), np.zeros_like(time)
