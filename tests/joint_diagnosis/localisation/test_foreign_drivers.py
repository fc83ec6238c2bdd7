"""Where no effect is named, an error that depends on what no base parameter knows of is outside the library."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null
from hjcamp.plants.pump_joint.diagnosis.localisation import drivers
from hjcamp.plants.pump_joint.diagnosis.selection import verdict

TESTS, BLOCKS, CHANNELS, SLIDING = 6, 200, 6, 4


@pytest.fixture
def features(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Six tests in three conditions in which the arm goes to and fro."""
    generator = np.random.default_rng(11)
    time = np.tile(0.02 * np.arange(BLOCKS), TESTS)
    speed = np.repeat(generator.uniform(1.5, 4.0, TESTS), BLOCKS)
    values = {
        "arm_angle": np.sin(speed * time),
        "arm_velocity": speed * np.cos(speed * time),
        "pump_velocity": speed * np.cos(speed * time),
        "direction": np.sign(np.cos(speed * time)),
        "time": time,
    }
    monkeypatch.setattr(drivers, "driver_values", lambda features: values)
    of_test = np.repeat(np.arange(TESTS), BLOCKS)
    evidence = SimpleNamespace(conditions={"a": [0, 1], "b": [2, 3], "c": [4, 5]})
    valid = np.ones((TESTS * BLOCKS, CHANNELS), dtype=bool)
    made = SimpleNamespace(evidence=evidence, of_test=of_test, counts=np.ones((TESTS, 1)), valid=valid, values=values)
    return cast(Any, made)


def found(features: Any, force: np.ndarray) -> str:
    """Return the driver that is found beside twins of pure noise."""
    generator = np.random.default_rng(12)

    def left(more: np.ndarray | float = 0.0) -> np.ndarray:
        noise = generator.standard_normal((TESTS * BLOCKS, CHANNELS))
        noise[:, SLIDING] += more
        return noise

    none = np.zeros(0)
    null = Null(none, none, np.ones(0, dtype=bool), none, [left() for _ in range(5)])
    return verdict._foreign(features, null, cast(Any, SimpleNamespace(features=left(force))))


def test_friction_at_one_angle_is_found(features: Any) -> None:
    angle, direction = features.values["arm_angle"], features.values["direction"]
    assert found(features, 3.0 * direction * np.exp(-0.5 * ((angle - 0.3) / 0.1) ** 2)) == "arm_angle"


def test_a_spring_is_found(features: Any) -> None:
    assert found(features, -1.5 * features.values["arm_angle"]) == "arm_angle"


def test_a_vibration_is_found(features: Any) -> None:
    assert found(features, 1.2 * np.sin(2 * np.pi * 9.0 * features.values["time"])) == "time"


def test_friction_that_is_off_everywhere_is_not_foreign(features: Any) -> None:
    assert found(features, 3.0 * features.values["direction"]) == ""


def test_noise_is_not_foreign(features: Any) -> None:
    assert found(features, np.zeros(TESTS * BLOCKS)) == ""
