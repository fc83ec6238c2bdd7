"""What drives an unexplained force is found in conditions that were left out, whether it is a slope or a spot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.discrepancy.drivers import KNOTS, _basis, _gain, straightness

TESTS, BLOCKS = 6, 200


@pytest.fixture
def features() -> Any:
    """Six tests in three conditions."""
    evidence = SimpleNamespace(conditions={"a": [0, 1], "b": [2, 3], "c": [4, 5]})
    return cast(Any, SimpleNamespace(evidence=evidence, of_test=np.repeat(np.arange(TESTS), BLOCKS)))


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


@pytest.mark.parametrize(("hidden", "straight"), [(np.sin, False), (lambda angle: 0.9 * angle, True)])
def test_a_spring_is_straighter_than_a_weight(features: Any, hidden: Any, straight: bool) -> None:
    generator = np.random.default_rng(7)
    angle = generator.uniform(-1.2, 1.2, TESTS * BLOCKS)
    sign = np.where(generator.random(len(angle)) < 0.5, -1.0, 1.0)
    features.counts = np.ones((TESTS, 1))
    force = hidden(angle) + 0.1 * sign + 0.1 * generator.standard_normal(len(angle))
    found = straightness(features, force, np.sin(angle), angle, sign, np.ones(len(angle), dtype=bool))
    assert found > 2.0 if straight else found < -2.0
