"""What twins allow: p-values, the error over that of the twins, and the allowance for a law's form."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null
from hjcamp.plants.pump_joint.diagnosis.levels import margin

TESTS, CHANNELS, TWINS = 12, 6, 40


def made(seed: int = 1, spread: float = 0.2) -> Null:
    generator = np.random.default_rng(seed)
    logarithms = spread * generator.standard_normal((TWINS, TESTS, CHANNELS))
    gains = generator.exponential(1.0, TWINS)
    return Null(gains, logarithms, np.ones((TESTS, CHANNELS), dtype=bool), np.zeros(CHANNELS))


def test_a_gain_that_no_twin_reaches_has_the_least_p_value() -> None:
    null = made()
    assert null.p_value(1e9) == pytest.approx(1 / (TWINS + 1))
    assert null.p_value(-1.0) == 1.0


def test_an_error_like_that_of_the_twins_is_one() -> None:
    null = made()
    assert null.over(np.exp(null.logarithms.mean(axis=0))) == pytest.approx(np.ones(CHANNELS))
    assert null.over(4.0 * np.exp(null.logarithms.mean(axis=0))) == pytest.approx(2.0 * np.ones(CHANNELS))


def test_most_twins_stay_within_their_own_limit() -> None:
    null, fresh = made(1), made(2)
    over = np.array([null.over(np.exp(one)) for one in fresh.logarithms])
    assert np.mean(over > null.highest()) < 0.15
    assert null.limit() == pytest.approx(margin() * null.highest()) and np.all(null.limit() > 1.0)


def test_a_test_that_says_nothing_in_a_channel_does_not_count() -> None:
    null = made()
    says = null.says.copy()
    says[1:, 4] = False
    quiet = Null(null.gains, null.logarithms, says, null.least)
    mean_square = np.exp(null.logarithms.mean(axis=0))
    mean_square[1:, 4] = 1e6
    assert quiet.over(mean_square)[4] == pytest.approx(1.0)


def test_a_law_may_be_off_by_a_share_of_what_it_explains() -> None:
    null = made(spread=1e-6)
    like = np.exp(null.logarithms.mean(axis=0))
    left = 0.9 * 0.15 * 20.0
    assert np.all(null.excess(like * 20.0**2, like * left**2, 0.15) < 1.0)
    assert np.all(null.excess(like * 20.0**2, like * left**2, 0.1) > 1.0)
    assert np.all(null.excess(like * left**2, like * left**2, 0.15) > 1.0)
