"""Everything the screening needs of residuals and responses: their products test by test, channel by channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features

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
        cross, square = self.with_residuals(residual[None])
        return cross[0], square[0]

    def with_residuals(self, residuals: Array) -> tuple[Array, Array]:
        """Return the products (residuals, tests, channels, columns) of residuals (residuals, blocks, channels) with the
        columns, and their squares (residuals, tests, channels)."""
        counts, edges = self.features.counts, self.features.edges
        cross = np.empty((len(residuals), *counts.shape, len(self.columns)))
        for test, (begin, end) in enumerate(pairwise(edges)):
            part = residuals[:, begin:end].transpose(2, 0, 1) @ self.columns[:, begin:end].transpose(2, 1, 0)
            cross[:, test] = part.swapaxes(0, 1) / counts[test][:, None]
        return cross, np.array([self.features.mean_square(residual) for residual in residuals])


def project(
    products: Array,
    cross: Array,
    square: Array,
    least: Array,
    columns: NDArray[np.int64],
    positive: NDArray[np.bool_],
    stiff: Array,
    pull: Array,
    train: Array,
    rounds: int,
) -> tuple[Array, Array, Array]:
    """Return losses (residuals, tests), coefficients (residuals, k) and errors (residuals, tests, channels) after a fit of
    each residual, on its own, on the tests in ``train``.

    Iteratively reweighted least squares on the logarithm of each test's error; a coefficient that must be positive and
    is not is left at zero. What is known beforehand of the coefficients x adds x' ``stiff`` x + 2 x' ``pull`` (k, k and
    residuals, k). ``rounds`` reweightings.
    """
    number, tests, channels = square.shape
    k = len(columns)
    # One row for each test and channel: all residuals together are then three matrix products.
    own = products[:, :, columns[:, None], columns].reshape(-1, k * k)
    across = cross[..., columns].reshape(number, -1, k)
    squares = square.reshape(number, -1)
    noise_floor, counted = np.tile(least**2, tests), np.repeat(train, channels)
    diagonal = np.arange(k)
    error, move = squares, np.zeros((number, k))
    for _ in range(rounds):
        weight = counted / (error + noise_floor)
        matrix = (weight @ own).reshape(number, k, k)
        matrix[:, diagonal, diagonal] = matrix[:, diagonal, diagonal] * (1.0 + 1e-6) + 1e-12
        move = _solved(matrix + stiff, -pull - (weight[:, None] @ across)[:, 0], positive)
        change = (move[:, :, None] * move[:, None]).reshape(number, -1) @ own.T
        error = np.maximum(squares + 2.0 * (across @ move[:, :, None])[:, :, 0] + change, 0.0)
    loss = np.log(error + noise_floor).reshape(number, tests, channels).sum(axis=2)
    return loss, move, error.reshape(square.shape)


def _solved(matrix: Array, right: Array, positive: NDArray[np.bool_]) -> Array:
    """Return the solutions (residuals, k), without the unknowns that must be positive and are not."""
    active = np.ones(right.shape, dtype=np.bool_)
    one = np.eye(len(positive))
    move = right
    for _ in range(3):
        both = active[:, :, None] & active[:, None]
        held = np.where(both, matrix, np.where(active[:, :, None], 0.0, one))
        move = np.linalg.solve(held, np.where(active, right, 0.0)[:, :, None])[:, :, 0]
        lost = positive & active & (move < 0.0)
        if not lost.any():
            break
        active &= ~lost
    return move


@dataclass(frozen=True)
class Known:
    """What is known beforehand of unknowns: one over the squared spread (n,), and how far they are from that already (..., n)."""

    stiff: Array
    away: Array

    def surplus(self, moves: Array) -> tuple[Array, Array]:
        """Return the matrix (k, k) and the pull (..., k) of coefficients that move the unknowns by ``moves`` (k, n) each."""
        return (moves * self.stiff) @ moves.T, (self.stiff * self.away) @ moves.T

    def squared(self, move: Array) -> Array:
        """Return the squared standard deviations (...) from what is known after a move (..., n)."""
        return np.asarray((self.away + move) ** 2 @ self.stiff)


@dataclass(frozen=True)
class Group:
    """The columns of one probe, whether each may be negative, and the moves (columns, base) of the base that go with them."""

    columns: tuple[int, ...]
    signed: tuple[bool, ...]
    shifts: Array


def all_gains(gram: Gram, residual: Array, known: Known, groups: Sequence[Group], rounds: int = 3) -> tuple[Array, list[Array]]:
    """Return the gains (groups,) of each group of columns over the base columns alone, and its coefficients.

    The first columns are the base parameters. What lets a parameter go back to where it was known to be gains by that, too.
    """
    cross, square = gram.with_residual(residual)
    gains, coefficients = gains_of_each(gram, cross[None], square[None], Known(known.stiff, known.away[None]), groups, rounds)
    return gains[0], [found[0] for found in coefficients]


def gains_of_each(
    gram: Gram, cross: Array, square: Array, known: Known, groups: Sequence[Group], rounds: int = 3
) -> tuple[Array, list[Array]]:
    """Return what `all_gains` does for each of several residuals, given by their products and squares (`with_residuals`):
    the gains (residuals, groups), and the coefficients (residuals, k) of each group."""
    train, count = np.ones(square.shape[1]), len(known.stiff)
    own = np.eye(count)

    def fitted(columns: NDArray[np.int64], positive: NDArray[np.bool_], moves: Array) -> tuple[Array, Array]:
        stiff, pull = known.surplus(moves)
        loss, found, _ = project(gram.products, cross, square, gram.least, columns, positive, stiff, pull, train, rounds)
        return loss.sum(axis=1) + known.squared(found @ moves), found

    free = np.zeros(count, dtype=np.bool_)
    alone, _ = fitted(np.arange(count), free, own)
    gains, coefficients = np.empty((len(square), len(groups))), []
    for index, group in enumerate(groups):
        columns = np.concatenate([np.arange(count), np.array(group.columns, dtype=np.int64)])
        positive = np.concatenate([free, ~np.array(group.signed, dtype=np.bool_)])
        after, found = fitted(columns, positive, np.concatenate([own, group.shifts]))
        gains[:, index] = alone - after
        coefficients.append(found)
    return gains, coefficients
