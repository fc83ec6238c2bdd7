"""The step within bounds is that of SciPy's solver, bit for bit, whether a bound is met or not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from hjcamp.diagnosis.estimation import bounded_step as module


@pytest.mark.parametrize("seed", range(60))
def test_least_squares_within_bounds(seed: int) -> None:
    draw = np.random.default_rng(seed)
    size = int(draw.integers(1, 7))
    rows, aims = draw.normal(size=(size + int(draw.integers(0, 3)), size)), draw.normal(size=size)
    aims = np.resize(aims, len(rows))
    reach = 10.0 ** draw.uniform(-2.0, 2.0, size)
    low, high = -reach * draw.uniform(0.0, 1.0, size), reach
    want = lsq_linear(rows, aims, (low, high), method="bvls").x
    np.testing.assert_array_equal(module._within(rows, aims, low, high), want)
