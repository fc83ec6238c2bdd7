"""Hold one angle: rest, or a step where the angle is not 0."""

from __future__ import annotations

import numpy as np

from hjcamp.trajectories.base import Array, Motion, Trajectory


class Hold(Trajectory):
    r"""One angle from time 0 on.

    .. math:: \theta = A

    With 0 deg all is to stay where it is (leakage and creep tests, thesis 4.4.4); with another angle it is the step
    of the stability method (thesis 5.2.1).
    """

    angle_deg: float = 0.0

    def motion(self, time: Array) -> Motion:
        return np.full_like(time, np.radians(self.angle_deg)), np.zeros_like(time), np.zeros_like(time)

    @property
    def first_direction(self) -> float:
        return -1.0 if self.angle_deg < 0.0 else 1.0

    @property
    def end_of_motion(self) -> float:
        return 0.0
