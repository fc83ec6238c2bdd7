"""Chapters: parts of the tests that are left out by turns, the unit in which two models are compared."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.fitting import Fitted
from hjcamp.prediction.likelihood import covariance, whitener
from hjcamp.prediction.windows import Layout

Array = NDArray[np.float64]
FEWEST = 8
MOST = 16


def chapters_of(layout: Layout) -> NDArray[np.int64]:
    """Return the chapter of each window (windows,).

    Conditions where there are enough of them, else tests, else equal parts of the tests one after the other.
    """
    measured, of_test = layout.measured, layout.of_test
    if len(measured.conditions) >= FEWEST:
        names = list(measured.conditions)
        return np.array([names.index(measured.tests[test].condition) for test in of_test])
    if len(measured.tests) >= FEWEST:
        return of_test
    parts = max(1, math.ceil(MOST / len(measured.tests)))
    found, count = np.zeros(len(of_test), dtype=np.int64), 0
    for test in np.unique(of_test):
        rows = np.flatnonzero(of_test == test)
        cut = np.minimum(np.arange(len(rows)) * min(parts, len(rows)) // len(rows), parts - 1)
        found[rows] = count + cut
        count += int(cut.max()) + 1
    return found


def left_out_scores(fitted: Fitted, chapters: NDArray[np.int64]) -> tuple[Array, Array]:
    r"""Return the log error of each chapter (chapters,) by the model that the others give, and the features so predicted.

    .. math:: s_c = \tfrac{1}{2} n_c d \log \Bigl( \frac{1}{n_c d} \sum_{w \in c} f_w^T C_{-c}^{-1} f_w \Bigr)

    for the n_c windows of a chapter and second moments C of the others: a chapter with one large error does not outweigh all.
    The fit without a chapter is one Gauss-Newton step from the fit of all (approximate cross-validation; Beirami et al. 2017).
    """
    w = whitener(fitted.features)
    white, left = np.einsum("wfp,fg->wgp", fitted.slopes, w), fitted.features @ w
    each = np.einsum("wgp,wgq->wpq", white, white)
    pull = np.einsum("wgp,wg->wp", white, left)
    whole = fitted.information
    found, features = [], np.empty_like(fitted.features)
    for chapter in np.unique(chapters):
        out = chapters == chapter
        step = (
            np.linalg.lstsq(whole - each[out].sum(axis=0), pull[out].sum(axis=0), rcond=1e-10)[0]
            if white.shape[2]
            else np.zeros(0)
        )
        moved = fitted.features + fitted.slopes @ step
        moments = covariance(moved[~out])
        features[out] = moved[out]
        root = np.linalg.cholesky(moments)
        square = np.mean(np.linalg.solve(root, moved[out].T) ** 2)
        found.append(0.5 * moved[out].size * np.log(square) + out.sum() * np.log(np.diag(root)).sum())
    return np.array(found), features


def better(one: Array, other: Array) -> float:
    """Return the t value of the paired differences ``other`` - ``one`` (chapters,): positive where ``one`` is better."""
    difference = other - one
    spread = float(np.std(difference, ddof=1)) / math.sqrt(len(difference)) if len(difference) > 1 else math.inf
    mean = float(np.mean(difference))
    return mean / spread if spread > 0.0 else math.copysign(math.inf, mean) if mean else 0.0
