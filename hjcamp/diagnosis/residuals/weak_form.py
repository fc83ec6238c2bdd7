"""Test functions of balances: smooth, and nothing at the ends of what they are taken over (Shinbrot 1957)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Test functions of a window: Legendre polynomials of these orders, and in samples how long they rise from nothing at its ends.
ORDERS, RISE = 4, 6
# A stretch of a window shorter than this (samples) has no balance: its test functions would hardly differ.
SHORTEST = 4 * RISE


def slides(side: Array, smoothed: int = 0) -> NDArray[np.bool_]:
    """Return in which samples (n,) a contact slides one way, with `RISE` samples on both sides of them.

    There are as many more as its speed is ``smoothed`` over on either side: nearer to rest it is partly that of the rest.
    """
    reach = RISE + smoothed
    same = (side != 0.0) & (np.append(side[1:], side[-1]) == side)
    return np.asarray(np.convolve(same, np.ones(2 * reach + 1), mode="same") > 2 * reach + 0.5)


def test_functions(use: NDArray[np.bool_]) -> Array:
    """Return the test functions of a window (width, orders) over its longest usable stretch of samples; 0 where that is short."""
    found = np.zeros((len(use), ORDERS))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], use.astype(int), [0]])))
    stretches = edges.reshape(-1, 2)
    if not len(stretches):
        return found
    low, high = stretches[np.argmax(stretches[:, 1] - stretches[:, 0])]
    length = high - low
    if length < SHORTEST:
        return found
    # the step from one sample to the next stands at its middle
    at = np.arange(length - 1) + 0.5
    ramp = np.clip(np.minimum(at, length - 1 - at) / RISE, 0.0, 1.0)
    rise = np.sin(0.5 * np.pi * ramp) ** 2
    powers = np.vander(np.linspace(-1.0, 1.0, length - 1), ORDERS, increasing=True) * rise[:, None]
    found[low : high - 1] = np.linalg.qr(powers)[0]
    return found
