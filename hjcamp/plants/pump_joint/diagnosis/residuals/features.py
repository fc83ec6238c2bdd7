"""Residuals as features: block means over 20 ms, weighed by test and channel with the logarithm of each test's error."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import block_means
from hjcamp.plants.pump_joint.diagnosis.residuals.views import HOME, WINDOWED

Array = NDArray[np.float64]
BLOCK = 5
# Fewer blocks in which the arm mostly slides are no sliding: a sample of it at an onset would count as a whole test.
LEAST_SLIDING = 5


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
    def valid(self) -> NDArray[np.bool_]:
        """Which features say something (blocks, channels): forces only where the arm mostly slides, or breaks away."""
        always = np.ones((len(self._shares), WINDOWED), dtype=bool)
        return np.hstack([always, self._shares > 0])

    @cached_property
    def _shares(self) -> Array:
        """Number of samples of each block in which the arm slides, in which it breaks away, and at which a test begins."""
        marks = np.zeros((int(self.evidence.edges[-1]), 3))
        marks[:, 0] = self.evidence.sliding
        marks[self.evidence.breakaways, 1] = 1.0
        marks[self.evidence.edges[:-1], 2] = np.isfinite(self.evidence.homes)
        shares = self._sums(marks)
        slides = shares[:, 0] > 0.5 * BLOCK
        enough = np.add.reduceat(slides.astype(int), self.edges[:-1]) >= LEAST_SLIDING
        shares[:, 0] *= slides & enough[self.of_test]
        return shares

    @cached_property
    def _members(self) -> Array:
        """Number of samples (blocks, channels) that a feature averages."""
        always = np.full((len(self._shares), WINDOWED), float(BLOCK))
        return np.hstack([always, np.maximum(self._shares, 1.0)])

    @cached_property
    def counts(self) -> Array:
        """Number of features that say something (tests, channels), at least 1."""
        return np.maximum(np.add.reduceat(self.valid.astype(float), self.edges[:-1], axis=0), 1.0)

    def _sums(self, values: Array) -> Array:
        total = values[self._starts]
        for later in range(1, BLOCK):
            total += values[self._starts + later]
        return np.asarray(total)

    def of(self, residuals: Array) -> Array:
        """Return the block means (blocks, channels) of residuals (n, channels); 0 where a feature says nothing."""
        return np.asarray(block_means(residuals, self._starts, BLOCK, self._members, self.valid))

    def shared(self, other: Features, values: Array) -> Array:
        """Return features (blocks, channels) of ``other`` evidence of these tests where both say something.

        In each test and channel they are as large as if all that say something here did there.
        """
        both = self.valid & other.valid
        number = np.add.reduceat(both.astype(float), self.edges[:-1], axis=0)
        return np.where(both, values * np.sqrt(self.counts / np.maximum(number, 1.0))[self.of_test], 0.0)

    def mean_square(self, features: Array) -> Array:
        """Return the mean square (tests, channels)."""
        return np.asarray(np.add.reduceat(features**2, self.edges[:-1], axis=0) / self.counts)

    def floor_by_condition(self, features: Array) -> Array:
        """Return the floor (conditions, channels) of each condition; NaN where its repetitions say too little."""
        totals, counts = self._unshared(features)
        return np.where(counts > 20, np.sqrt(totals / np.maximum(counts, 1)), np.nan)

    def _unshared(self, features: Array) -> tuple[Array, Array]:
        """Return the sums of squares (conditions, channels) that repetitions do not share, and what they are sums over."""
        totals, counts = [], []
        for tests in self.evidence.conditions.values():
            shortest = int(min(self.edges[index + 1] - self.edges[index] for index in tests))
            block = np.stack([features[self.edges[index] : self.edges[index] + shortest] for index in tests])
            seen = np.stack([self.valid[self.edges[index] : self.edges[index] + shortest] for index in tests])
            number = seen.sum(axis=0)
            mean = np.where(seen, block, 0.0).sum(axis=0) / np.maximum(number, 1)
            left = np.where(seen, (block - mean) ** 2, 0.0).sum(axis=0)
            shared = number > 1
            totals.append(np.where(shared, left * number / np.maximum(number - 1, 1), 0.0).sum(axis=0))
            counts.append(np.where(shared, number, 0).sum(axis=0))
        return np.array(totals), np.array(counts)

    def noise_floor(self, features: Array) -> Array:
        r"""Return the floor (channels,): what the repetitions of a condition do not share.

        .. math:: \sigma^2 = \frac{1}{N} \sum_c \frac{R_c}{R_c - 1} \sum_{r,t} (r_{crt} - \bar r_{ct})^2

        over the conditions c with R_c > 1 repetitions. Without any repetition the whole residual counts as floor. Where
        tests begin has the scatter of all tests.
        """
        totals, counts = self._unshared(features)
        total, count = totals.sum(axis=0), counts.sum(axis=0)
        whole = np.sqrt((features**2).sum(axis=0) / np.maximum(self.valid.sum(axis=0), 1))
        noise_floor = np.where(count > 20, np.sqrt(total / np.maximum(count, 1)), whole)
        noise_floor[HOME] = self.evidence.home_scatter
        return noise_floor


def log_error(mean_square: Array, least: Array) -> float:
    """Return the loss: the sum over tests and channels of log(mean square + least^2)."""
    return float(np.log(mean_square + least**2).sum())
