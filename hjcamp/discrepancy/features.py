"""Residuals as features: block means over 20 ms, weighed by test and channel with the logarithm of each test's error."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.evidence import Evidence

Array = NDArray[np.float64]
BLOCK = 5


@dataclass(frozen=True)
class Features:
    """How residuals (n, channels) of an evidence become features (blocks, channels), and which block is whose."""

    evidence: Evidence

    @cached_property
    def _starts(self) -> NDArray[np.int64]:
        starts = [
            np.arange(begin, end - BLOCK + 1, BLOCK)
            for begin, end in zip(self.evidence.edges[:-1], self.evidence.edges[1:], strict=True)
        ]
        return np.concatenate(starts)

    @cached_property
    def of_test(self) -> NDArray[np.int64]:
        """The position of the test that each block belongs to."""
        return self.evidence.of_test[self._starts]

    @cached_property
    def edges(self) -> NDArray[np.int64]:
        """Where the blocks of each test begin, and their number at the end."""
        return np.searchsorted(self.of_test, np.arange(len(self.evidence.tests) + 1))

    @cached_property
    def counts(self) -> Array:
        """Blocks of each test (tests,)."""
        return np.diff(self.edges).astype(float)

    def of(self, residuals: Array) -> Array:
        """Return the block means (blocks, channels) of residuals (n, channels)."""
        total = np.cumsum(np.vstack([np.zeros(residuals.shape[1]), residuals]), axis=0)
        return (total[self._starts + BLOCK] - total[self._starts]) / BLOCK

    def mean_square(self, features: Array) -> Array:
        """Return the mean square (tests, channels)."""
        return np.asarray(np.add.reduceat(features**2, self.edges[:-1], axis=0) / self.counts[:, None])

    def floor(self, features: Array) -> Array:
        """Return the floor (channels,): what the repetitions of a condition do not share (see floor.py)."""
        total, count = np.zeros(features.shape[1]), 0
        for tests in self.evidence.conditions.values():
            if len(tests) < 2:
                continue
            shortest = int(min(self.counts[index] for index in tests))
            block = np.stack([features[self.edges[index] : self.edges[index] + shortest] for index in tests])
            total += ((block - block.mean(axis=0)) ** 2).sum(axis=(0, 1)) * len(tests) / (len(tests) - 1)
            count += shortest * len(tests)
        if count == 0:
            return np.sqrt(np.mean(features**2, axis=0))
        return np.asarray(np.sqrt(total / count))


def log_error(mean_square: Array, least: Array) -> float:
    """Return the loss: the sum over tests and channels of log(mean square + least^2)."""
    return float(np.log(mean_square + least**2).sum())
