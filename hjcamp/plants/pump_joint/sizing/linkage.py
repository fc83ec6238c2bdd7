"""The six-bar joint: two cylinders on one crank (thesis 3.5)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Of the pressure angle, the usual limit for linkages (Balli & Chand 2002); the thesis gives its range alone.
LARGEST_PRESSURE_ANGLE = math.radians(45.0)


def mobility(links: float, joints: float) -> float:
    """Return the degrees of freedom 3 (n - 1) - 2 j of a planar linkage with one-degree joints. Source: thesis 3.5.1."""
    return 3.0 * (links - 1.0) - 2.0 * joints


@dataclass(frozen=True)
class SixBar:
    r"""One loop of the joint: rod r1 from the slider at (x - x0, y0) to the crank pin at r2 (sin th, cos th). SI units.

    .. math:: x = x_0 + r_2 \sin\theta - \sqrt{r_1^2 - (r_2 \cos\theta - y_0)^2}, \quad
              x_0 = \sqrt{r_1^2 - (r_2 - y_0)^2}

    Angles in rad. The figure is not available: that the printed lengths close at theta = 0 confirms the reading.
    Source: thesis 3.5, dimensions of its prototype.
    """

    rod: float = 9.7e-3
    crank: float = 6.2e-3
    offset: float = 4.0e-3
    start: float = 9.45e-3

    def closure(self) -> float:
        """Return the rod's length that closes the loop at theta = 0, m."""
        return math.hypot(self.start, self.crank - self.offset)

    def travel(self, angle: Array) -> Array:
        """Return the slider's travel from where the crank is at theta = 0, m."""
        return self.crank * np.sin(angle) + self._root(np.zeros(())) - self._root(angle)

    def lever(self, angle: Array) -> Array:
        r"""Return dx/dtheta, m: torque in N*m for one newton of the cylinder, no friction."""
        rise = self.crank * np.cos(angle) - self.offset
        return self.crank * np.cos(angle) - rise * self.crank * np.sin(angle) / self._root(angle)

    def pressure_angle(self, angle: Array) -> Array:
        """Return the angle between the rod's force and the crank pin's motion, rad."""
        return angle + np.arctan2(self.crank * np.cos(angle) - self.offset, self._root(angle))

    def usable_range(self, largest: float = LARGEST_PRESSURE_ANGLE) -> tuple[float, float]:
        """Return the angles (rad) between which the pressure angle stays within ``largest``."""
        from scipy.optimize import brentq

        dead = math.radians(75.0)
        low = brentq(lambda angle: float(self.pressure_angle(np.array(angle))) + largest, -dead, 0.0)
        high = brentq(lambda angle: float(self.pressure_angle(np.array(angle))) - largest, 0.0, dead)
        return low, high

    def best_line(self, half_range: float) -> tuple[float, float]:
        """Return the slope (rad/m) and offset (rad) of the least-squares line x(theta) over +-``half_range``, as theta(x)."""
        angle = np.linspace(-half_range, half_range, 801)
        travel_per_rad, travel = np.polyfit(angle, self.travel(angle), 1)
        return 1.0 / float(travel_per_rad), -float(travel) / float(travel_per_rad)

    def worst_of_line(self, half_range: float) -> float:
        """Return how far theta(x) is from `best_line` at most, rad."""
        angle = np.linspace(-half_range, half_range, 801)
        slope, offset = self.best_line(half_range)
        return float(np.max(np.abs(slope * self.travel(angle) + offset - angle)))

    def common_volume(self, angle: Array, bore: float) -> Array:
        """Return by how much both cylinders together hold more water than at rest, m^3; the second loop mirrors the first.

        .. math:: \\Delta V = A_2 (x(\\theta) + x(-\\theta))
        """
        return math.pi / 4.0 * bore**2 * (self.travel(angle) + self.travel(-np.asarray(angle)))

    def _root(self, angle: Array) -> Array:
        return np.sqrt(self.rod**2 - (self.crank * np.cos(angle) - self.offset) ** 2)
