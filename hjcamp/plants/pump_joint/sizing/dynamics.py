"""What a transfer function can follow: rise time, bandwidth and phase (thesis 4.3)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

HALF_POWER = 2.0**-0.5


def response(frequency: NDArray[np.float64], a2: float, a1: float, a0: float, delay: float = 0.0) -> NDArray[np.complex128]:
    r"""Return the response at frequencies in Hz, relative to that at rest.

    .. math:: G(s)/G(0) = a_0 e^{-\tau s} / (s^3 + a_2 s^2 + a_1 s + a_0)

    SI units. Source: thesis 4.3.2 to 4.3.4.
    """
    s = 2j * math.pi * np.asarray(frequency, dtype=float)
    return a0 * np.exp(-delay * s) / (s**3 + a2 * s**2 + a1 * s + a0)


def bandwidth(a2: float, a1: float, a0: float) -> float:
    """Return the lowest frequency in Hz at which `response` has fallen by 3 dB; a delay does not matter."""
    from scipy.optimize import brentq

    grid = np.geomspace(1e-3, 1e4, 4001) * a0 ** (1.0 / 3.0) / (2.0 * math.pi)
    below = int(np.argmax(np.abs(response(grid, a2, a1, a0)) < HALF_POWER))

    def excess(frequency: float) -> float:
        return float(np.abs(response(np.array(frequency), a2, a1, a0))) - HALF_POWER

    return float(brentq(excess, grid[below - 1], grid[below]))


def rise_time(numerator: float, a2: float, a1: float, a0: float) -> float:
    """Return the time from 10 to 90 % of the answer to a step, s. Source: thesis 4.3 (definition)."""
    from scipy.signal import TransferFunction, step

    longest = 20.0 / abs(np.max(np.roots([1.0, a2, a1, a0]).real))
    time, answer = step(TransferFunction([numerator], [1.0, a2, a1, a0]), T=np.linspace(0.0, longest, 20001))
    share = answer / (numerator / a0)
    low, high = (int(np.argmax(share > level)) for level in (0.1, 0.9))
    return float(time[high] - time[low])
