"""Sine about the start angle."""

from __future__ import annotations

import numpy as np

from hjcamp.trajectories.base import Array, Motion, Trajectory


class Sine(Trajectory):
    r"""Sine about 0, starting at full speed.

    .. math:: \theta = A \sin(2 \pi f t)

    Source: thesis 5.2.5, trajectories c and d; open loop thesis 4.6.2.
    """

    amplitude_deg: float
    frequency_hz: float

    def motion(self, time: Array) -> Motion:
        amplitude = np.radians(self.amplitude_deg)
        angular_frequency = 2.0 * np.pi * self.frequency_hz
        angle = amplitude * np.sin(angular_frequency * time)
        return angle, amplitude * angular_frequency * np.cos(angular_frequency * time), -(angular_frequency**2) * angle
