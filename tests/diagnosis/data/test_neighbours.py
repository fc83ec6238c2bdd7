"""Neighbours are found some windows at a time: those that the whole table of distances has."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.diagnosis.data.repeatability import NEIGHBOURS, _neighbours


@pytest.mark.parametrize(("count", "width"), [(41, 1), (60, 3), (300, 5)])
def test_the_nearest_of_the_whole_table(count: int, width: int) -> None:
    motion = np.random.default_rng(count).normal(size=(count, width))
    motion[7] = motion[30]  # equal motions stand first
    table = np.sum((motion[:, None] - motion[None]) ** 2, axis=2) / width
    for k in range(count):
        table[k, max(k - 1, 0) : k + 2] = np.inf
    want = np.argsort(table, axis=1)[:, :NEIGHBOURS]
    parts = [_neighbours(motion, rows) for rows in np.array_split(np.arange(count), 3)]
    order, distance = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    np.testing.assert_array_equal(order, want)
    np.testing.assert_allclose(distance, np.take_along_axis(table, want, axis=1), atol=1e-12)
    assert order[7, 0] == 30 and np.all(np.abs(order - np.arange(count)[:, None]) > 1)
