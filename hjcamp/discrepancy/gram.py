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
    products: Any, cross: Any, square: Any, least: Any, columns: Any, positive: Any, stiff: Any, train: Any, rounds: int
) -> Any:
    """Return loss (tests,), coefficients (k,) and error (tests, channels) after a fit on the tests in ``train``.

    Iteratively reweighted least squares on the logarithm of each test's error; a coefficient that must be positive and
    is not is left at zero. ``stiff`` (k,): one over the squared spread with which a coefficient is known. ``rounds``
    reweightings.
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
        b = np.zeros(k)
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
            a[i, i] += 1e-12 + stiff[i]
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


def all_gains(
    gram: Gram,
    residual: Array,
    base: Array,
    groups: Sequence[tuple[tuple[int, ...], tuple[bool, ...]]],
    rounds: int = 3,
) -> tuple[Array, Array, list[Array]]:
    """Return the loss (tests,) with the base columns alone, the gains (groups, tests) of each group, its coefficients.

    The first columns are the base parameters, each known beforehand as ``base`` says (one over its squared spread); a
    group is (columns, signed).
    """
    cross, square = gram.with_residual(residual)
    train = np.ones(len(square))
    own = np.arange(len(base))
    free = np.zeros(len(base), dtype=np.bool_)
    loss, _, _ = project(gram.products, cross, square, gram.least, own, free, base, train, rounds)
    gains, coefficients = np.empty((len(groups), len(square))), []
    for index, (columns, signed) in enumerate(groups):
        chosen = np.concatenate([own, np.array(columns)])
        positive = np.concatenate([free, ~np.array(signed, dtype=np.bool_)])
        stiff = np.concatenate([base, np.zeros(len(columns))])
        after, move, _ = project(gram.products, cross, square, gram.least, chosen, positive, stiff, train, rounds)
        gains[index] = loss - after
        coefficients.append(move)
    return loss, gains, coefficients
