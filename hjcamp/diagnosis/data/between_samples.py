"""What is given between two samples, in the stretches in which a model is simulated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def halves(
    begins: Array, ends: Array, first: Array, length: float, within: tuple[NDArray[np.int64], NDArray[np.int64]]
) -> tuple[Array, Array]:
    r"""Return the mean m of stretches of ``length`` samples, and d with which m - d, then m + d have their first moment.

    .. math:: d = \frac{4}{L^2} \int_{-L/2}^{L/2} s\, u(s)\, \mathrm{d}s

    What is given runs from ``begins`` to ``ends`` (n,) in each sample; stretches begin at ``first`` (k,), in samples, and are one at
    most. Before the first sample ``within`` its test (k,) and after the last it is what it is there. Both halves stay within that.
    """
    at = np.floor(first)
    cut, end_of = np.minimum(first - at + length, 1.0), first - at + length
    whole, moment = np.zeros((2, len(first)))
    low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
    for rows, start, end, offset in ((at, first - at, cut, at - first), (at + 1.0, 0.0 * cut, end_of - cut, at + 1.0 - first)):
        inside = np.clip(rows, *within).astype(int)
        out = rows != inside
        rise = np.where(out, 0.0, ends[inside] - begins[inside])
        level = np.where(rows > inside, ends[inside], begins[inside])
        own = (end - start) * (level + 0.5 * rise * (start + end))
        whole += own
        moment += level * (end**2 - start**2) / 2.0 + rise * (end**3 - start**3) / 3.0 + (offset - 0.5 * length) * own
        for edge in (level + rise * start, level + rise * end):
            there = end > start
            low, high = np.where(there, np.minimum(low, edge), low), np.where(there, np.maximum(high, edge), high)
    mean = whole / length
    most = np.maximum(np.minimum(high - mean, mean - low), 0.0)
    return mean, np.clip(4.0 * moment / length**2, -most, most)
