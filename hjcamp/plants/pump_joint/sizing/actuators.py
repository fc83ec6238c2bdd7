"""Cylinders, vanes and throttling: what area, seal, force and torque an actuator of a size has (thesis 3.3, 3.4, 3.8)."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])


def cylinder_area(bore: float) -> float:
    """Return the area pi D^2/4 under pressure, m^2. Source: thesis 3.3.1."""
    return math.pi / 4.0 * bore**2


def double_vane_area(bore: float, shaft: float, length: Number) -> Number:
    """Return the area (D - d) l of both vanes, m^2. Source: thesis 3.3.2."""
    return (bore - shaft) * length


def area_ratio(bore: float, shaft: float, length: float) -> float:
    """Return how many times the area of a cylinder of the same bore a double vane has. Source: thesis 3.3."""
    return double_vane_area(bore, shaft, length) / cylinder_area(bore)


def cylinder_seal(bore: float) -> float:
    """Return the length of a piston's seal, m: pi D. Source: thesis 3.3."""
    return math.pi * bore


def double_vane_seal(bore: float, shaft: float, length: Number) -> Number:
    """Return the length of the seals of a double vane, m: 2 (l + D - d), tip and two sides of each vane.

    The thesis prints the value alone; tip and sides give it. Source: thesis 3.3.
    """
    return 2.0 * (length + bore - shaft)


def seal_ratio(bore: float, shaft: float, length: float) -> float:
    """Return how many times the seal of a cylinder of the same bore a double vane has. Source: thesis 3.3."""
    return double_vane_seal(bore, shaft, length) / cylinder_seal(bore)


def vane_torque(pressure: float, vanes: float, bore: float, shaft: float, length: Number) -> Number:
    r"""Return the torque of a vane actuator in N*m, without friction.

    .. math:: M = \Delta p\, n\, l\, (D^2 - d^2)/8

    SI units; ``pressure`` is the difference across a vane. Source: statics, not in the thesis.
    """
    return pressure * vanes * length * (bore**2 - shaft**2) / 8.0


def plate_torque(pressure: float, area: float, mean_radius: float) -> float:
    """Return the torque dp A r of a plate under pressure at a mean radius, N*m. Source: thesis 3.3 (area and torque)."""
    return pressure * area * mean_radius


def torque_per_pressure(torque: float, pressure: float) -> float:
    """Return N*m per Pa (m^3): what an actuator gives, whatever its inside. Source: thesis 2.2.5.3, 3.3 (numbers)."""
    return torque / pressure


def cylinder_force(pressure: float, bore: float) -> float:
    """Return p pi D^2/4 in N, without friction. Source: thesis 3.4."""
    return pressure * cylinder_area(bore)


def throttle_loss(supply: float, difference: float) -> float:
    """Return the share of the supply's power lost in valves, 1 - (p1 - p2)/ps; a pump that displaces has none.

    Steady motion, return at zero gauge. Source: thesis 3.8 says it in words.
    """
    return 1.0 - difference / supply
