"""Curve: positions at equal steps of time, with a smooth curve through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.trajectories.base import Array, Motion, Trajectory, check_number

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

MOST_VALUES = 10_000


class Curve(Trajectory):
    """A cubic spline through ``values_deg``, ``step_time`` apart, at rest at both ends; the first value is 0.

    Velocity and acceleration are the spline's own. Raises ``UsageError`` for fewer than three values.
    """

    values_deg: Sequence[float]
    step_time: float
    duration: float = field(init=False)

    def check(self) -> None:
        values = self.values_deg
        if isinstance(values, str) or not isinstance(values, Sequence) or not 3 <= len(values) <= MOST_VALUES:
            raise UsageError(f"trajectory.values_deg must be a list of 3 to {MOST_VALUES} numbers")
        for place, value in enumerate(values):
            check_number(f"trajectory.values_deg[{place}]", value, "deg")
        if values[0] != 0.0:
            raise UsageError(f"trajectory.values_deg[0] is {values[0]:g}; a motion begins at 0")
        object.__setattr__(self, "duration", (len(values) - 1) * self.step_time)

    @cached_property
    def _spline(self) -> CubicSpline:
        from scipy.interpolate import CubicSpline

        time = np.arange(len(self.values_deg)) * self.step_time
        return CubicSpline(time, np.radians(np.asarray(self.values_deg, dtype=np.float64)), bc_type="clamped")

    def motion(self, time: Array) -> Motion:
        spline: Any = self._spline
        return spline(time), spline(time, 1), spline(time, 2)

    @property
    def first_direction(self) -> float:
        steps = np.diff(self.values_deg)
        moving = steps[steps != 0.0]
        return -1.0 if len(moving) and moving[0] < 0.0 else 1.0
