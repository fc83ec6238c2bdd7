"""The floor of the error: the part of the residual that the repetitions of a condition do not share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.evidence import Evidence

Array = NDArray[np.float64]


def repetition_floor(evidence: Evidence, residuals: Array) -> Array:
    r"""Return the floor (channels,) of residuals (n, channels), in their unit.

    .. math:: \sigma^2 = \frac{1}{N} \sum_{c} \frac{1}{R_c - 1} \sum_{r,t} (r_{crt} - \bar r_{ct})^2

    over the conditions c with R_c > 1 repetitions. Without any repetition the whole residual counts as floor.
    """
    total, count = np.zeros(residuals.shape[1]), 0
    edges = evidence.edges
    for tests in evidence.conditions.values():
        if len(tests) < 2:
            continue
        shortest = min(evidence.tests[index].samples for index in tests)
        block = np.stack([residuals[edges[index] : edges[index] + shortest] for index in tests])
        total += ((block - block.mean(axis=0)) ** 2).sum(axis=(0, 1)) * len(tests) / (len(tests) - 1)
        count += shortest * len(tests)
    if count == 0:
        return np.sqrt(np.mean(residuals**2, axis=0))
    return np.asarray(np.sqrt(total / count))


def by_test(evidence: Evidence, residuals: Array) -> Array:
    """Return the mean square (tests, channels) of the residuals of each test."""
    sums = np.add.reduceat(residuals**2, evidence.edges[:-1], axis=0)
    return np.asarray(sums / np.diff(evidence.edges)[:, None])
