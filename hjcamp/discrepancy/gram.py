"""Everything the screening needs of residuals and responses: their products test by test, channel by channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hjcamp.discrepancy.features import Features

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Gram:
    """Products (tests, channels, ...) of the columns with each other and of a residual with them, per block."""

    columns: Array
    features: Features
    products: Array
    least: Array

    @classmethod
    def of(cls, columns: Array, features: Features, least: Array) -> Gram:
        """Return the products of columns (columns, blocks, channels)."""
        tests, channels, count = len(features.counts), columns.shape[2], len(columns)
        products = np.empty((tests, channels, count, count))
        for test in range(tests):
            part = columns[:, features.edges[test] : features.edges[test + 1], :]
            for channel in range(channels):
                block = np.ascontiguousarray(part[:, :, channel])
                products[test, channel] = block @ block.T / features.counts[test, channel]
        return cls(columns, features, products, least)

    def with_residual(self, residual: Array) -> tuple[Array, Array]:
        """Return the products (tests, channels, columns) of a residual (blocks, channels) with the columns, and its square."""
        weighted = self.columns * residual[None]
        sums = np.add.reduceat(weighted, self.features.edges[:-1], axis=1) / self.features.counts[None]
        return np.ascontiguousarray(np.moveaxis(sums, 0, 2)), self.features.mean_square(residual)


@njit(cache=True)
def project(
    products: Any,
    cross: Any,
    square: Any,
    least: Any,
    columns: Any,
    positive: Any,
    stiff: Any,
    pull: Any,
    train: Any,
    rounds: int,
) -> Any:
    """Return loss (tests,), coefficients (k,) and error (tests, channels) after a fit on the tests in ``train``.

    Iteratively reweighted least squares on the logarithm of each test's error; a coefficient that must be positive and
    is not is left at zero. What is known beforehand of the coefficients x adds x' ``stiff`` x + 2 x' ``pull`` (k, k and k).
    ``rounds`` reweightings.
    """
    tests, channels = square.shape
    k = len(columns)
    weight = np.empty((tests, channels))
    error = square.copy()
    move: Any = np.zeros(k)
    active = np.ones(k, dtype=np.bool_)
    for _ in range(rounds):
        for t in range(tests):
            for c in range(channels):
                weight[t, c] = train[t] / (error[t, c] + least[c] ** 2)
        a = np.zeros((k, k))
        b = -pull
        for t in range(tests):
            if train[t] == 0.0:
                continue
            for c in range(channels):
                w = weight[t, c]
                for i in range(k):
                    b[i] -= w * cross[t, c, columns[i]]
                    for j in range(i + 1):
                        a[i, j] += w * products[t, c, columns[i], columns[j]]
        for i in range(k):
            for j in range(i):
                a[j, i] = a[i, j]
        for i in range(k):
            a[i, i] *= 1.0 + 1e-6
            a[i, i] += 1e-12
        a += stiff
        for i in range(k):
            active[i] = True
        for _again in range(3):
            m = a.copy()
            v = b.copy()
            for i in range(k):
                if not active[i]:
                    for j in range(k):
                        m[i, j] = 0.0
                        m[j, i] = 0.0
                    m[i, i] = 1.0
                    v[i] = 0.0
            move = np.linalg.solve(m, v)
            changed = False
            for i in range(k):
                if positive[i] and active[i] and move[i] < 0.0:
                    active[i] = False
                    changed = True
            if not changed:
                break
        for t in range(tests):
            for c in range(channels):
                value = square[t, c]
                for i in range(k):
                    value += 2.0 * move[i] * cross[t, c, columns[i]]
                    for j in range(k):
                        value += move[i] * move[j] * products[t, c, columns[i], columns[j]]
                error[t, c] = max(value, 0.0)
    loss = np.zeros(tests)
    for t in range(tests):
        for c in range(channels):
            loss[t] += np.log(error[t, c] + least[c] ** 2)
    return loss, move, error


@dataclass(frozen=True)
class Known:
    """What is known beforehand of unknowns (n,): one over the squared spread, and how far they are from that already."""

    stiff: Array
    away: Array

    def surplus(self, moves: Array) -> tuple[Array, Array]:
        """Return the matrix (k, k) and the pull (k,) of coefficients that move the unknowns by ``moves`` (k, n) each."""
        return (moves * self.stiff) @ moves.T, moves @ (self.stiff * self.away)

    def squared(self, move: Array) -> float:
        """Return the squared standard deviations from what is known after a move (n,)."""
        return float(self.stiff @ (self.away + move) ** 2)


@dataclass(frozen=True)
class Group:
    """The columns of one probe, whether each may be negative, and the moves (columns, base) of the base that go with them."""

    columns: tuple[int, ...]
    signed: tuple[bool, ...]
    shifts: Array


def all_gains(
    gram: Gram, residual: Array, known: Known, groups: Sequence[Group], rounds: int = 3
) -> tuple[Array, list[Array]]:
    """Return the gains (groups,) of each group of columns over the base columns alone, and its coefficients.

    The first columns are the base parameters. What lets a parameter go back to where it was known to be gains by that, too.
    """
    cross, square = gram.with_residual(residual)
    train, count = np.ones(len(square)), len(known.stiff)
    own = np.eye(count)

    def fitted(columns: NDArray[np.int64], positive: NDArray[np.bool_], moves: Array) -> tuple[float, Array]:
        stiff, pull = known.surplus(moves)
        loss, found, _ = project(
            gram.products, cross, square, gram.least, columns, positive, stiff, pull, train, rounds
        )
        return float(loss.sum()) + known.squared(found @ moves), found

    free = np.zeros(count, dtype=np.bool_)
    alone, _ = fitted(np.arange(count), free, own)
    gains, coefficients = np.empty(len(groups)), []
    for index, group in enumerate(groups):
        columns = np.concatenate([np.arange(count), np.array(group.columns, dtype=np.int64)])
        positive = np.concatenate([free, ~np.array(group.signed, dtype=np.bool_)])
        after, found = fitted(columns, positive, np.concatenate([own, group.shifts]))
        gains[index] = alone - after
        coefficients.append(found)
    return gains, coefficients
