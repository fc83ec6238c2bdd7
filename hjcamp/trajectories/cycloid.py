"""Cycloid: a smooth rise, then rest."""

from __future__ import annotations

import numpy as np

from hjcamp.trajectories import laws
from hjcamp.trajectories.base import Array, Motion, Trajectory, check_rise


class Cycloid(Trajectory):
    r"""Cycloidal motion to an angle, then rest there; the steady state error is taken from the rest.

    .. math:: \theta = A \left( \frac{t}{T} - \frac{1}{2 \pi} \sin \frac{2 \pi t}{T} \right) \quad (t < T)

    Source: thesis 5.2.5, trajectories e and f.
    """

    amplitude_deg: float
    rise_time: float

    def check(self) -> None:
        check_rise(self.rise_time, self.duration)

    def motion(self, time: Array) -> Motion:
        return laws.rise(laws.cycloid, time, self.rise_time, np.radians(self.amplitude_deg))

    @property
    def end_of_motion(self) -> float:
        return self.rise_time
