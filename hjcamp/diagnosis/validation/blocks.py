"""Blocks: parts of the tests that are left out by turns, the unit in which two models are compared."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.estimation.bounded_step import bounded_step
from hjcamp.diagnosis.estimation.gauss_newton import Fitted, moved_by, room_of, whole_loss
from hjcamp.diagnosis.estimation.likelihood import covariance, whitener
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.residuals.windows import Windows

Array = NDArray[np.float64]
FEWEST = 8
MOST = 16
# Of more conditions neighbours are left out together, so that the time grows with the samples and not with their square.
MOST_LEFT_OUT = 2 * MOST
# Of a step that makes worse what it should make better, a shorter one is tried, and in the end none is taken.
SHARES = (1.0, 0.5, 0.25)


def blocks_of(layout: Layout) -> NDArray[np.int64]:
    """Return the block of each window (windows,): equal parts of each condition, its repetitions together.

    Repetitions share what a condition has of its own: apart, they would pass for independent. Where tests are simulated through
    no block is shorter than the plant's memory.
    """
    measured, of_test = layout.measured, layout.of_test
    conditions = list(measured.conditions)
    most = min(MOST, len(of_test) * layout.width // layout.memory) if layout.memory else MOST
    parts = math.ceil(most / len(conditions))
    found = np.zeros(len(of_test), dtype=np.int64)
    for test in np.unique(of_test):
        rows = np.flatnonzero(of_test == test)
        cut = np.arange(len(rows)) * min(parts, len(rows)) // len(rows)
        found[rows] = parts * conditions.index(measured.tests[test].condition) + cut
    return found


def left_out(windows: Windows, fitted: Fitted, blocks: NDArray[np.int64]) -> Array:
    """Return the features (windows, d) of each block by the fit of the others; of very many blocks some are left out together.

    The parameters without a block are one Gauss-Newton step of the others' loss from those of all (approximate cross-validation;
    Beirami et al. 2017), a shorter one where the whole makes that loss larger; what they predict is simulated.
    """
    w = whitener(fitted.features)
    white, left = np.einsum("wfp,fg->wgp", fitted.slopes, w), fitted.features @ w
    each = np.einsum("wgp,wgq->wpq", white, white)
    pull = np.einsum("wgp,wg->wp", white, left)
    whole, known = fitted.information, np.array([one.slope * one.surprise(fitted.candidate) for one in fitted.free])
    features = fitted.features.copy()
    if not fitted.free:
        return features
    # where the fit has not ended, each fit without a block has as far to go
    room = room_of(fitted.free, fitted.candidate)
    ahead = bounded_step(whole, -pull.sum(axis=0) - known, *room)
    for out in _together(blocks):
        step = bounded_step(whole - each[out].sum(axis=0), -pull[~out].sum(axis=0) - known, *room) - ahead
        least = whole_loss(fitted.features[~out], fitted.candidate, fitted.free)
        for share in SHARES:
            moved = moved_by(fitted.candidate, fitted.free, share * step)
            found = windows.features(moved)
            # what the others know is no worse for them than what all know
            if whole_loss(found[~out], moved, fitted.free) <= least and np.all(np.isfinite(found[out])):
                features[out] = found[out]
                break
    return features


def _together(blocks: NDArray[np.int64]) -> Iterator[NDArray[np.bool_]]:
    """Yield which windows (windows,) are left out together: a block, or neighbouring blocks where there are very many."""
    names, place = np.unique(blocks, return_inverse=True)
    groups = place * min(len(names), MOST_LEFT_OUT) // len(names)
    for group in np.unique(groups):
        yield groups == group


def advantages(one: Array, other: Array, blocks: NDArray[np.int64]) -> Array:
    r"""Return by how much features ``one`` (windows, d) are better than ``other`` in each block (blocks,).

    .. math:: a_c = \sum_{w \in c} \tfrac{d}{2} \log \frac{d + g_w^T M^{-1} g_w}{d + f_w^T M^{-1} f_w}

    for features f of one, g of the other, and M half the sum of their second moments: the log scores of Student's t. One large
    error does not outweigh all, and a difference far below what either model leaves elsewhere counts for nothing.
    """
    d = one.shape[1]
    inverse = np.linalg.inv(0.5 * (covariance(one) + covariance(other)))
    squares = [np.einsum("wi,ij,wj->w", f, inverse, f) for f in (one, other)]
    gains = 0.5 * d * np.log((d + squares[1]) / (d + squares[0]))
    return np.array([gains[blocks == block].sum() for block in np.unique(blocks)])


def discrimination(one: Array, other: Array, blocks: NDArray[np.int64]) -> Array:
    r"""Return how much each block (blocks,) would speak for either model against the other, were it right.

    .. math:: e_c = \sum_{w \in c} \tfrac{d}{2} \log\Bigl(1 + \frac{\Delta_w^T M^{-1} \Delta_w}{2 d}\Bigr), \quad \Delta_w = g_w - f_w

    for features f and g (windows, d), M as in `advantages`.
    """
    d, apart = one.shape[1], other - one
    inverse = np.linalg.inv(0.5 * (covariance(one) + covariance(other)))
    each = 0.5 * d * np.log1p(np.einsum("wi,ij,wj->w", apart, inverse, apart) / (2.0 * d))
    return np.array([each[blocks == block].sum() for block in np.unique(blocks)])


def ratio_t(values: Array, weights: Array) -> tuple[float, float]:
    r"""Return Student's t of the ratio of ``values`` to ``weights`` (blocks,), and the number of blocks that it stands on.

    .. math:: b = \frac{\sum a_c}{\sum e_c}, \quad s^2 = \sum \Bigl(\frac{a_c - b\,e_c}{\sum e - e_c}\Bigr)^2, \quad t = \frac{b}{s},
              \quad n = \frac{(\sum e_c)^2}{\sum e_c^2}

    An advantage grows with what the block distinguishes two models by: one in which both say the same speaks neither for nor
    against. The spread is the jackknife's (Cochran 1977, Sampling Techniques, sections 6.3 and 6.16).
    """
    whole = float(weights.sum())
    if len(weights) < 2 or whole <= 0.0:
        return 0.0, 1.0
    count = whole**2 / float(np.sum(weights**2))
    share = float(values.sum()) / whole
    rest = np.maximum(whole - weights, 1e-12 * whole)
    spread = math.sqrt(float(np.sum(((values - share * weights) / rest) ** 2)))
    return (share / spread if spread > 0.0 else math.copysign(math.inf, share) if share else 0.0), count


def critical(blocks: float, level: float = LEVEL) -> float:
    """Return the one-sided critical value of Student's t over a number of blocks at a level."""
    from scipy.special import stdtrit

    return float(stdtrit(blocks - 1.0, 1.0 - level)) if blocks > 1.0 + 1e-9 else math.inf


def chance_of_t(t: float, blocks: float) -> float:
    """Return how often Student's t over a number of blocks is as large by chance."""
    from scipy.special import stdtr

    return float(stdtr(max(blocks - 1.0, 1.0), -t))
