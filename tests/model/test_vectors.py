"""Sums of four rows at once, against the same in plain Python: bit for bit."""

import os

import numpy as np
import pytest
from numba import njit

from hjcamp.model.compile.vectors import ahead, ahead_in_python, strided, strided_in_python

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")
STEPS = np.random.default_rng(1).standard_normal((3, 64))
SPACE = np.random.default_rng(2).standard_normal((4, 64)) * (np.random.default_rng(3).random((4, 64)) < 0.7)


@njit
def moved(a, z, steps, x, y):  # type: ignore[no-untyped-def]
    ahead(a, z, 0, 4, steps, 1, (0, 16, 24), (x, y, x * y))
    ahead(a, z, 4, 3, steps, 2, (4,), (x,))


@njit
def summed(space, row, block):  # type: ignore[no-untyped-def]
    return strided(space, 1, 8 * row, 2, block, 8)


def test_four_states_or_fewer_are_moved_as_in_python() -> None:
    z, found, expected = np.linspace(-1.0, 1.0, 7), np.zeros(7), np.zeros(7)
    moved(found, z, STEPS, 0.1, -1 / 3)
    ahead_in_python(expected, z, 0, 4, STEPS, 1, (0, 16, 24), (0.1, -1 / 3, 0.1 * (-1 / 3)))
    ahead_in_python(expected, z, 4, 3, STEPS, 2, (4,), (0.1,))
    assert found.tobytes() == expected.tobytes()


def test_a_product_is_summed_as_in_python() -> None:
    for row in range(8):
        for block in (0, 4):
            assert summed(SPACE, row, block) == strided_in_python(SPACE, 1, 8 * row, 2, block, 8)
            direct = SPACE[1, 8 * row : 8 * row + 8] @ SPACE[2].reshape(8, 8)[:, block : block + 4]
            np.testing.assert_allclose(summed(SPACE, row, block), direct, rtol=1e-12, atol=1e-14)
