"""Ramp: constant speed, then rest."""

from __future__ import annotations

import numpy as np

from hjcamp.trajectories.base import Array, Motion, Trajectory, check_rise
from hjcamp.trajectories.laws import linear, rise


class Ramp(Trajectory):
    r"""Constant speed to an angle, then rest there.

    .. math:: \theta = A \, t / T \quad (t < T)

    Source: thesis 5.2.5, trajectories a and b.
    """

    amplitude_deg: float
    rise_time: float

    def check(self) -> None:
        check_rise(self.rise_time, self.duration)

    def motion(self, time: Array) -> Motion:
        return rise(linear, time, self.rise_time, np.radians(self.amplitude_deg))

    @property
    def end_of_motion(self) -> float:
        return self.rise_time
