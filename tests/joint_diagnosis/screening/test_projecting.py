"""Many residuals are weighed at once as each would be on its own."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.screening.normal_equations import (
    Gram,
    Group,
    Known,
    all_gains,
    gains_of_each,
    project,
)

Array = Any
TESTS, CHANNELS, BLOCKS, COLUMNS, RESIDUALS = 5, 3, 40, 6, 8


def one_by_one(
    products: Array, cross: Array, square: Array, least: Array, columns: Array, positive: Array, stiff: Array, pull: Array,
    train: Array, rounds: int,
) -> tuple[Array, Array, Array]:  # fmt: skip
    """The same fit of one residual, written with loops."""
    k = len(columns)
    error, move = square.copy(), np.zeros(k)
    for _ in range(rounds):
        weight = train[:, None] / (error + least**2)
        matrix, right = np.zeros((k, k)), -pull
        for t in range(len(square)):
            for c in range(len(least)):
                matrix += weight[t, c] * products[t, c][np.ix_(columns, columns)]
                right = right - weight[t, c] * cross[t, c, columns]
        matrix += 1e-6 * np.diag(np.diag(matrix)) + 1e-12 * np.eye(k) + stiff
        active = np.ones(k, dtype=bool)
        for _again in range(3):
            inside = np.flatnonzero(active)
            move = np.zeros(k)
            move[inside] = np.linalg.solve(matrix[np.ix_(inside, inside)], right[inside])
            lost = positive & active & (move < 0.0)
            if not lost.any():
                break
            active &= ~lost
        for t in range(len(square)):
            for c in range(len(least)):
                own = products[t, c][np.ix_(columns, columns)]
                error[t, c] = max(square[t, c] + 2.0 * move @ cross[t, c, columns] + move @ own @ move, 0.0)
    return np.log(error + least**2).sum(axis=1), move, error


@pytest.fixture
def gram() -> Gram:
    generator = np.random.default_rng(3)
    edges, counts = np.arange(TESTS + 1) * BLOCKS, np.full((TESTS, CHANNELS), float(BLOCKS))
    features: Any = SimpleNamespace(edges=edges, counts=counts)
    features.mean_square = lambda residual: np.add.reduceat(residual**2, edges[:-1], axis=0) / counts
    columns = generator.standard_normal((COLUMNS, TESTS * BLOCKS, CHANNELS))
    return Gram.of(columns, features, np.array([0.1, 0.2, 0.3]))


@pytest.fixture
def residuals(gram: Gram) -> Array:
    generator = np.random.default_rng(4)
    mixed = np.einsum("rk,kbc->rbc", generator.standard_normal((RESIDUALS, COLUMNS)), gram.columns)
    return mixed + generator.standard_normal(mixed.shape)


def test_each_residual_is_fitted_as_it_is_alone(gram: Gram, residuals: Array) -> None:
    generator = np.random.default_rng(5)
    columns, positive = np.array([0, 1, 3, 5]), np.array([False, False, True, True])
    stiff, pull = np.diag([0.0, 2.0, 0.0, 1.0]), 0.3 * generator.standard_normal((RESIDUALS, 4))
    train = np.array([1.0, 1.0, 0.0, 2.0, 1.0])
    cross, square = gram.with_residuals(residuals)
    found = project(gram.products, cross, square, gram.least, columns, positive, stiff, pull, train, 3)
    held = 0
    for one in range(RESIDUALS):
        alone = one_by_one(gram.products, cross[one], square[one], gram.least, columns, positive, stiff, pull[one], train, 3)
        held += int((alone[1][positive] == 0.0).sum())
        for ours, theirs in zip(found, alone, strict=True):
            np.testing.assert_allclose(ours[one], theirs, rtol=1e-9, atol=1e-12)
    assert held > 0, "nothing was held at zero: the test says nothing about that"


def test_products_are_sums_over_the_blocks_of_each_test(gram: Gram, residuals: Array) -> None:
    cross, square = gram.with_residuals(residuals)
    plain = (gram.columns[None] * residuals[:, None]).reshape(RESIDUALS, COLUMNS, TESTS, BLOCKS, CHANNELS).mean(axis=3)
    np.testing.assert_allclose(cross, np.moveaxis(plain, 1, 3), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(square, (residuals**2).reshape(RESIDUALS, TESTS, BLOCKS, CHANNELS).mean(axis=2))


def test_gains_of_many_are_those_of_each(gram: Gram, residuals: Array) -> None:
    stiff, away = np.array([1.0, 4.0]), np.random.default_rng(6).standard_normal((RESIDUALS, 2))
    groups = [
        Group((2,), (False,), np.array([[0.1, 0.0]])),
        Group((3, 4), (True, False), np.array([[0.0, 0.2], [0.3, 0.0]])),
        Group((5,), (True,), np.zeros((1, 2))),
    ]
    gains, coefficients = gains_of_each(gram, *gram.with_residuals(residuals), Known(stiff, away), groups)
    for one, residual in enumerate(residuals):
        alone, found = all_gains(gram, residual, Known(stiff, away[one]), groups)
        np.testing.assert_allclose(gains[one], alone, rtol=1e-9, atol=1e-9)
        for ours, theirs in zip(coefficients, found, strict=True):
            np.testing.assert_allclose(ours[one], theirs, rtol=1e-9, atol=1e-12)
