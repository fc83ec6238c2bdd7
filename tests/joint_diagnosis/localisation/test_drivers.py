"""What drives an unexplained force is found in conditions that were left out, whether it is a slope or a spot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import (
    KNOTS,
    _basis,
    _gain,
    _rhythm,
    _swings,
    bends,
    outdone,
)

TESTS, BLOCKS = 6, 200


@pytest.fixture
def features() -> Any:
    """Six tests in three conditions."""
    evidence = SimpleNamespace(conditions={"a": [0, 1], "b": [2, 3], "c": [4, 5]})
    of_test = np.repeat(np.arange(TESTS), BLOCKS)
    return cast(Any, SimpleNamespace(evidence=evidence, of_test=of_test, counts=np.ones((TESTS, 1))))


def shares(features: Any, force: np.ndarray, driver: np.ndarray) -> list[float]:
    valid = np.ones(len(force), dtype=bool)
    return [_gain(features, force, valid, _basis(driver, None, count)) for count in KNOTS]


def test_a_spot_needs_many_knots_and_a_slope_few(features: Any) -> None:
    generator = np.random.default_rng(5)
    angle = generator.uniform(-1.0, 1.0, TESTS * BLOCKS)
    noise = 0.2 * generator.standard_normal(len(angle))
    few, _, many = shares(features, np.exp(-0.5 * ((angle - 0.3) / 0.05) ** 2) + noise, angle)
    assert many > 0.4 > 2 * few
    few, _, many = shares(features, angle + noise, angle)
    assert few > 0.85
    assert many > 0.85


def test_what_depends_on_nothing_is_not_explained(features: Any) -> None:
    generator = np.random.default_rng(6)
    force = generator.standard_normal(TESTS * BLOCKS)
    assert max(shares(features, force, generator.uniform(-1.0, 1.0, len(force)))) < 0.02


def motion(generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, direction and noise (blocks,) of all tests."""
    count = TESTS * BLOCKS
    sign = np.where(generator.random(count) < 0.5, -1.0, 1.0)
    return generator.uniform(-1.2, 1.2, count), sign, 0.1 * sign + 0.1 * generator.standard_normal(count)


@pytest.mark.parametrize(("hidden", "straight"), [(np.sin, False), (lambda angle: 0.9 * angle, True)])
def test_a_spring_is_straighter_than_a_weight(features: Any, hidden: Any, straight: bool) -> None:
    angle, sign, others = motion(np.random.default_rng(7))
    every = np.ones(len(angle), dtype=bool)
    found = outdone(features, hidden(angle) + others, np.sin(angle), [angle], sign, every)
    assert found > 2.0 if straight else found < -2.0


@pytest.mark.parametrize(("hidden", "stop"), [(np.sin, False), (lambda angle: np.maximum(angle - 0.4, 0.0), True)])
def test_a_stop_sets_in_at_one_place_and_a_weight_does_not(features: Any, hidden: Any, stop: bool) -> None:
    angle, sign, others = motion(np.random.default_rng(8))
    every = np.ones(len(angle), dtype=bool)
    # the weight whose curve is as like a stop as it can be
    law = np.sin(angle) if not stop else -np.cos(angle + 0.9)
    found = outdone(features, hidden(angle) + others, law, bends(angle, every), sign, every)
    assert found > 2.0 if stop else found < -2.0


def moving(time: np.ndarray, frequency: float) -> dict[str, np.ndarray]:
    """Return the drivers of an arm that goes to and fro with one frequency, Hz."""
    speed = np.cos(2 * np.pi * frequency * time)
    return {"time": time, "arm_velocity": speed, "pump_velocity": speed, "direction": np.sign(speed)}


@pytest.mark.parametrize("shaken", [("a", "b", "c"), ("b",)])
def test_a_swing_counts_where_all_conditions_have_it(features: Any, shaken: tuple[str, ...]) -> None:
    generator = np.random.default_rng(9)
    time = np.tile(0.02 * np.arange(BLOCKS), TESTS)
    force = generator.standard_normal(len(time))
    for name in shaken:
        for test in features.evidence.conditions[name]:
            rows = features.of_test == test
            force[rows] += 1.5 * np.sin(2 * np.pi * 7.0 * time[rows] + test)
    share = _rhythm(features, force, _swings(features, np.ones(len(time), dtype=bool), moving(time, 1.0)))
    # 1.5^2 / 2 beside a variance of 1
    assert share == pytest.approx(1.125 / 2.125, abs=0.08) if len(shaken) == 3 else abs(share) < 0.05


@pytest.mark.parametrize("frequency", [7.0, 7.12, 7.37])
def test_a_swing_is_found_at_any_frequency(features: Any, frequency: float) -> None:
    time = np.tile(0.02 * np.arange(BLOCKS), TESTS)
    force = np.sin(2 * np.pi * frequency * time + features.of_test)
    shares = _rhythm(features, force, _swings(features, np.ones(len(time), dtype=bool), moving(time, 1.0)))
    assert shares > 0.9


def test_a_swing_in_step_with_the_motion_is_no_foreign_one(features: Any) -> None:
    generator = np.random.default_rng(10)
    time = np.tile(0.02 * np.arange(BLOCKS), TESTS)
    drivers, every = moving(time, 2.0), np.ones(len(time), dtype=bool)
    # what a model of friction leaves: the third harmonic of the motion
    left = generator.standard_normal(len(time)) + 1.5 * np.sin(2 * np.pi * 6.0 * time)
    assert _rhythm(features, left, _swings(features, every, moving(time, 0.3))) > 0.4
    assert abs(_rhythm(features, left, _swings(features, every, drivers))) < 0.05
