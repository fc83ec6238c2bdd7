"""What a regression on the motion takes: a product, a memory, no noise; and its parts left out against fits made without them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from carriage import measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.repeatability import moves
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.validation.kernel_regression import RIDGES, kernel, predictions, regressed, regression_of

CHANCE = np.random.default_rng(7)
MOTION = CHANCE.standard_normal((240, 3))
PARTS = np.repeat(np.arange(12), 20)


def left(values: np.ndarray, *described: np.ndarray) -> float:
    """Return the share of the rms that a regression leaves."""
    found = regressed(described or (MOTION,), values, PARTS)
    return float(np.sqrt(np.mean(found**2) / np.mean(values**2)))


def test_each_part_is_predicted_as_a_fit_without_it_would() -> None:
    values = np.column_stack([MOTION[:, 0] * MOTION[:, 1], CHANCE.standard_normal(240)])
    within = kernel(MOTION, 1.0)
    for ridge, found in zip(RIDGES, predictions(within, values, PARTS), strict=True):
        for part in (0, 5):
            own, rest = np.isin(PARTS, part), ~np.isin(PARTS, part)
            solved = np.linalg.solve(within[np.ix_(rest, rest)] + ridge * np.eye(rest.sum()), values[rest])
            assert np.allclose(found[own], within[np.ix_(own, rest)] @ solved, atol=1e-6)


def test_a_product_of_two_is_taken_and_noise_is_not() -> None:
    noise = CHANCE.standard_normal((240, 2))
    assert left(noise) > 0.98
    product = (MOTION[:, :1] * MOTION[:, 1:2]) @ np.ones((1, 2))
    assert left(product + 0.1 * noise) < 0.3


def test_what_was_before_is_taken_where_it_is_described() -> None:
    before = np.roll(MOTION, 1, axis=0)
    values = np.sin(before[:, :1]) + 0.1 * CHANCE.standard_normal((240, 1))
    assert left(values) > 0.95
    assert left(values, MOTION, np.hstack([MOTION, before])) < 0.5


def test_noise_that_is_more_than_the_motion_of_a_window_does_not_tell_itself(axis: Path) -> None:
    # curvatures of what was measured are the noise's own, which is what is left
    measured = measured_tests([measured_log(seconds=6.0, noise=3e-4, path=lambda t: 0.05 * np.sin(2.0 * np.pi * 0.1 * t))])
    analysis = calibrated(measured, {}, unknowns=False, width=16)
    layout, base = analysis.windows.layout, analysis.base
    told = regression_of(layout, base.features, analysis.search.blocks, analysis.search.predicted(base))
    assert analysis.channels.share(told.features, base.features[told.rows], base.features) < 0.05
    # nor where the motion is described by the readings that hold it: a curvature that is mostly noise describes none
    own = regression_of(layout, base.features, analysis.search.blocks, layout.readings)
    assert not moves(layout)[2] and moves(layout)[0]
    assert analysis.channels.share(own.features, base.features[own.rows], base.features) < 0.05
