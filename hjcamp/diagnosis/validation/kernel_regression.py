r"""How much of what a model leaves follows from what was measured, by whatever law: kernel regression on the motion.

.. math:: \hat f(x) = k(x)^T (K + \lambda I)^{-1} F, \quad k(x, x') = e^{-|x - x'|^2 / 2 \ell^2} + x^T x' + 1

for windows with features F and motion x (Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, section 2.2). Each
block is predicted from the others. What is predicted so is no noise, and no law of one driver need describe it: a force that
depends on two quantities, a memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import motion_of, moves
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.estimation.likelihood import whitener

Array = NDArray[np.float64]
# In spreads of the motion; the other blocks choose among these.
LENGTHS = (0.5, 1.0, 2.0, 4.0)
RIDGES = np.logspace(-2.0, 3.0, 8)
# Of more windows, so many are looked at, evenly spread.
MOST_WINDOWS = 1000


@dataclass(frozen=True)
class Regression:
    """Features (windows, d) that a regression on the motion leaves of blocks left out, at ``rows`` (windows,) of all windows."""

    rows: NDArray[np.int64]
    features: Array


def regression_of(layout: Layout, features: Array, blocks: NDArray[np.int64], readings: Array) -> Regression:
    """Return what a regression of features (windows, d) on the windows' motion, with and without the one before, leaves."""
    rows = spread_over(len(features), MOST_WINDOWS)
    motion, white = motion_of(layout, readings)[:, moves(layout)], whitener(features)
    described = [motion[rows], with_before(layout, motion)[rows]]
    left = regressed(described, (features @ white)[rows], blocks[rows])
    return Regression(rows, left @ np.linalg.inv(white))


def spread_over(count: int, most: int) -> NDArray[np.int64]:
    """Return the places of at most so many of ``count`` windows, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def with_before(layout: Layout, motion: Array) -> Array:
    """Return motions (windows, m) with those of the window before next to them (windows, 2 m); a test's first has its own again."""
    first = np.concatenate([[True], layout.of_test[1:] != layout.of_test[:-1]])
    return np.hstack([motion, np.where(first[:, None], motion, np.roll(motion, 1, axis=0))])


def regressed(described: Sequence[Array], values: Array, parts: NDArray[np.int64]) -> Array:
    """Return the residual of values (n, d) in each part (n,) by the regression of the others on one of the descriptions (n, m)."""
    tried = [np.zeros_like(values)]
    for one in (each for each in described if each.shape[1]):
        for length in LENGTHS:
            tried += predictions(kernel(one, length), values, parts)
    return _chosen(values, np.array(tried), parts)


def kernel(motion: Array, length: float) -> Array:
    """Return the kernel (windows, windows) of motions (windows, m)."""
    m = motion.shape[1]
    inner = motion @ motion.T / m
    square = np.diag(inner)
    apart = np.maximum(square[:, None] + square[None, :] - 2.0 * inner, 0.0)
    return np.asarray(np.exp(-0.5 * apart / length**2) + inner + 1.0)


def predictions(within: Array, values: Array, parts: NDArray[np.int64]) -> list[Array]:
    """Return what the others predict of each part of the values (windows, d) with a kernel (windows, windows), for every ridge."""
    size, along = np.linalg.eigh(within)
    found = []
    for ridge in RIDGES:
        hat = (along * (size / (size + ridge))) @ along.T
        left, predicted = values - hat @ values, np.empty_like(values)
        for part in np.unique(parts):
            own = np.flatnonzero(parts == part)
            # the residual without a part, from that with it (Cook & Weisberg 1982, section 2.2)
            predicted[own] = values[own] - np.linalg.solve(np.eye(len(own)) - hat[np.ix_(own, own)], left[own])
        found.append(predicted)
    return found


def _chosen(values: Array, tried: Array, parts: NDArray[np.int64]) -> Array:
    """Return the residual of values (windows, d) by that of the predictions (tried, windows, d) that does best in all other parts."""
    squares, left = (values - tried) ** 2, np.empty_like(values)
    for part in np.unique(parts):
        out = parts == part
        best = np.argmin(squares[:, ~out].sum(axis=1), axis=0)
        left[out] = values[out] - np.take_along_axis(tried[:, out], best[None, None, :], axis=0)[0]
    return left
