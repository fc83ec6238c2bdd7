"""Chapters: parts of the tests that are left out by turns, the unit in which two models are compared."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.fitting import Fitted
from hjcamp.prediction.likelihood import covariance, whitener
from hjcamp.prediction.windows import Layout, Windows

Array = NDArray[np.float64]
FEWEST = 8
MOST = 16


def chapters_of(layout: Layout) -> NDArray[np.int64]:
    """Return the chapter of each window (windows,): equal parts of each condition, its repetitions together.

    Repetitions share what a condition has of its own: apart, they would pass for independent.
    """
    measured, of_test = layout.measured, layout.of_test
    conditions = list(measured.conditions)
    parts = math.ceil(MOST / len(conditions))
    found = np.zeros(len(of_test), dtype=np.int64)
    for test in np.unique(of_test):
        rows = np.flatnonzero(of_test == test)
        cut = np.arange(len(rows)) * min(parts, len(rows)) // len(rows)
        found[rows] = parts * conditions.index(measured.tests[test].condition) + cut
    return found


def left_out(windows: Windows, fitted: Fitted, chapters: NDArray[np.int64]) -> Array:
    """Return the features (windows, d) of each chapter by the fit of the others.

    The parameters without a chapter are one Gauss-Newton step of the others' loss from those of all (approximate cross-validation;
    Beirami et al. 2017); what they predict is simulated.
    """
    w = whitener(fitted.features)
    white, left = np.einsum("wfp,fg->wgp", fitted.slopes, w), fitted.features @ w
    each = np.einsum("wgp,wgq->wpq", white, white)
    pull = np.einsum("wgp,wg->wp", white, left)
    whole, known = fitted.information, np.array([one.slope * one.surprise(fitted.candidate) for one in fitted.free])
    features = fitted.features.copy()
    if not fitted.free:
        return features
    # where the fit has not ended, each fit without a chapter has as far to go
    ahead = np.linalg.lstsq(whole, pull.sum(axis=0) + known, rcond=1e-10)[0]
    for chapter in np.unique(chapters):
        out = chapters == chapter
        step = ahead - np.linalg.lstsq(whole - each[out].sum(axis=0), pull[~out].sum(axis=0) + known, rcond=1e-10)[0]
        moved = fitted.candidate
        for one, x in zip(fitted.free, step, strict=True):
            moved = one.into(moved, one.of(moved) + float(x))
        found = windows.features(moved)[out]
        features[out] = found if np.all(np.isfinite(found)) else fitted.features[out] + fitted.slopes[out] @ step
    return features


def advantages(one: Array, other: Array, chapters: NDArray[np.int64]) -> Array:
    r"""Return by how much features ``one`` (windows, d) are better than ``other`` in each chapter (chapters,).

    .. math:: a_c = \sum_{w \in c} \tfrac{d}{2} \log \frac{d + g_w^T M^{-1} g_w}{d + f_w^T M^{-1} f_w}

    for features f of one, g of the other, and M half the sum of their second moments: the log scores of Student's t. One large
    error does not outweigh all, and a difference far below what either model leaves elsewhere counts for nothing.
    """
    d = one.shape[1]
    inverse = np.linalg.inv(0.5 * (covariance(one) + covariance(other)))
    squares = [np.einsum("wi,ij,wj->w", f, inverse, f) for f in (one, other)]
    gains = 0.5 * d * np.log((d + squares[1]) / (d + squares[0]))
    return np.array([gains[chapters == chapter].sum() for chapter in np.unique(chapters)])


def t_value(values: Array) -> float:
    """Return Student's t of the mean of ``values`` (chapters,)."""
    spread = float(np.std(values, ddof=1)) / math.sqrt(len(values)) if len(values) > 1 else math.inf
    mean = float(np.mean(values))
    return mean / spread if spread > 0.0 else math.copysign(math.inf, mean) if mean else 0.0
