"""Blocks speak for a model by what they could tell, and parameters without one are no worse for the others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.validation import blocks
from hjcamp.diagnosis.validation.blocks import advantages, discrimination, left_out, ratio_t


def test_the_ratio_of_two_blocks_by_hand() -> None:
    t, count = ratio_t(np.array([1.0, 5.0]), np.array([1.0, 2.0]))
    assert t == pytest.approx(2.0 / np.sqrt(0.5**2 + 1.0**2)) and count == pytest.approx(9.0 / 5.0)


def test_a_block_that_tells_nothing_counts_for_nothing() -> None:
    values, weights = np.array([3.0, 4.0, 2.5, 3.5]), np.array([3.0, 3.5, 3.0, 3.0])
    few = ratio_t(values, weights)
    many = ratio_t(np.append(values, np.zeros(12)), np.append(weights, np.zeros(12)))
    assert many == pytest.approx(few) and few[1] == pytest.approx(4.0, rel=0.02)


def test_one_block_alone_is_no_evidence() -> None:
    assert ratio_t(np.array([50.0, 0.0]), np.array([40.0, 0.0]))[1] == pytest.approx(1.0)
    assert ratio_t(np.array([50.0]), np.array([40.0])) == (0.0, 1.0)
    assert ratio_t(np.zeros(3), np.zeros(3)) == (0.0, 1.0)


def test_noise_alone_is_rarely_beyond_what_the_level_allows() -> None:
    from scipy.special import stdtrit

    generator = np.random.default_rng(4)
    beyond = 0
    for _ in range(400):
        weights = generator.exponential(2.0, 16)
        t, count = ratio_t(np.sqrt(weights) * generator.normal(size=16), weights)
        beyond += t > stdtrit(count - 1.0, 0.95)
    assert 4 <= beyond <= 36  # 20 are expected at 5 %


def test_the_right_model_has_the_advantage_in_each_block() -> None:
    generator = np.random.default_rng(5)
    right = generator.normal(size=(80, 4))
    wrong = right + 1.5 * np.repeat([1.0, 0.0], 40)[:, None]
    of = np.repeat(np.arange(8), 10)
    found, could = advantages(right, wrong, of), discrimination(right, wrong, of)
    assert np.all(found[:4] > 0.0) and np.all(could[:4] > 1.0)
    assert np.all(found[4:] == 0.0) and np.all(could[4:] == 0.0)


def test_a_step_that_is_worse_for_the_others_is_not_taken(axis: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = calibrated(measured_tests([measured_log()]), {}, unknowns=False)
    fitted, of = analysis.base.fitted, analysis.search.blocks
    # five parameters of 16 blocks: far below the noise of any window
    moved = np.abs(left_out(analysis.windows, fitted, of) - fitted.features)
    assert moved.max() < 1.5 and np.sqrt(np.mean(moved**2)) < 0.1
    step: Any = blocks.bounded_step
    monkeypatch.setattr(blocks, "bounded_step", lambda *a: 1e4 * step(*a) + 3.0)
    assert np.array_equal(left_out(analysis.windows, fitted, of), fitted.features)


@pytest.mark.parametrize("count", [1, 16, 30, 31, 32, 33, 40, 160, 640])
def test_blocks_are_left_out_by_themselves_unless_they_are_very_many(count: int) -> None:
    of = np.repeat(np.arange(count) * 3 + 1, 3)
    groups = list(blocks._together(of))
    assert len(groups) == min(count, blocks.MOST_LEFT_OUT)
    assert np.array_equal(np.sum(groups, axis=0), np.ones(len(of)))  # each window once
    for out in groups:
        assert {int(np.sum(out & (of == one))) for one in np.unique(of[out])} == {3}  # no block is cut
        assert out.sum() <= 3 * -(-count // len(groups))
