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


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("left", [0.0, -1e-20, 1e-310])
def test_a_parameter_that_nothing_tells_but_rounding_stays_and_the_others_move_as_without_it(seed: int, left: float) -> None:
    chance = np.random.default_rng(seed)
    rows, aims = chance.standard_normal((30, 4)), chance.standard_normal(30)
    whole = np.zeros((5, 5))
    whole[:4, :4] = rows.T @ rows
    # as where the blocks that tell it are taken from all: its own curvature is gone, what it shares is rounding
    whole[4, 4], whole[4, :4] = left, 1e-12 * chance.standard_normal(4)
    whole[:4, 4] = whole[4, :4]
    downhill = np.append(rows.T @ aims, 1e-12)
    low, high = np.full(5, -5.0), np.full(5, 5.0)
    found = module.bounded_step(whole, downhill, low, high)
    assert np.all(np.isfinite(found))
    assert found[:4] == pytest.approx(module.bounded_step(whole[:4, :4], downhill[:4], low[:4], high[:4]), abs=1e-6)
