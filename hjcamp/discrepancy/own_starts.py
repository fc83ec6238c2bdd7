"""What a test begins with and no rig repeats: a value of its own for each test, beside the one that all share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ROUNDS = 4
# A share of the range over which a residual is linear enough.
STEP = 0.1


def step_within(value: float, bounds: tuple[float, float]) -> float:
    """Return a tenth of the range, upwards where there is room for it."""
    low, high = bounds
    step = STEP * (high - low)
    return step if value + step <= high else -step


def own_moves(
    residual: Array, response: Array, edges: NDArray[np.int64], least: float, room: tuple[float, float]
) -> Array:
    r"""Return by how much the value of each test (tests,) differs from the common one.

    .. math:: x_t = \arg\min_x \sum_c \log\bigl(\langle (r_{tc} + x\,d_{tc})^2 \rangle + l^2\bigr)

    for the residual r and its response d to the common value (n, channels), within ``room`` (lowest and highest move);
    ``least`` is what an error must exceed to count. Solved by weighing the channels anew in each round.
    """
    counts = np.diff(edges)[:, None]
    square, cross, own = (
        np.add.reduceat(product, edges[:-1], axis=0) / counts
        for product in (residual**2, residual * response, response**2)
    )
    moves = np.zeros(len(counts))
    for _ in range(ROUNDS):
        left = square + 2.0 * moves[:, None] * cross + moves[:, None] ** 2 * own
        weights = 1.0 / (left + least**2)
        down, across = (weights * cross).sum(axis=1), (weights * own).sum(axis=1)
        moves = np.clip(np.where(across > 0.0, -down / np.maximum(across, 1e-300), 0.0), *room)
    return np.asarray(moves)
