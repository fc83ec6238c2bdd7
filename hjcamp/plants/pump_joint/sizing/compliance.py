"""The pressure of a closed line against the water pushed into it (thesis 4.4.3, 5.6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.sizing.tubing import ATMOSPHERE, effective_modulus

Array = NDArray[np.float64]
STEPS = 2001


def pressure_against_volume(
    volume: float, water: float, tubing: float, air_fraction: float, highest: float
) -> tuple[Array, Array]:
    r"""Return the volume pushed in (m^3) and the gauge pressure (Pa) of a line from 0 gauge to ``highest``.

    .. math:: \Delta V = V \int_{0}^{p} \frac{dp}{\beta_e(p)}

    with the effective modulus of 4.4.3.14 at each absolute pressure. SI units. Source: thesis 4.4.3.13, Figure 4.4.3.
    """
    gauge = np.linspace(0.0, highest, STEPS)
    weakness = np.array([1.0 / effective_modulus(water, tubing, air_fraction, p + ATMOSPHERE) for p in gauge])
    steps = 0.5 * (weakness[1:] + weakness[:-1]) * np.diff(gauge)
    return volume * np.concatenate([[0.0], np.cumsum(steps)]), gauge
