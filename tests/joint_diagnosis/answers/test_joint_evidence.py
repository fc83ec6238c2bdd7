"""Which test and channel of the joint the evidence shows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.plants.pump_joint.answers.evidence import Shown, _correlations, _worst_test
from hjcamp.plants.pump_joint.diagnosis.localisation import unexplained

TIME = np.arange(300) * 0.004
MEASURED = {
    "arm": np.sin(TIME),
    "pressure1": 3e5 + 1e4 * TIME,
    "pressure2": 3e5 - 1e4 * TIME,
    "time": TIME,
    "pump": np.cos(TIME),
}


def found() -> Any:
    """Return a diagnosis of three tests of equal length."""
    evidence = SimpleNamespace(
        edges=np.array([0, 100, 200, 300]),
        tests=[SimpleNamespace(name=f"ramp/{k}") for k in range(3)],
        joined=lambda name: MEASURED[name],
        conditions={"up": (0, 2), "down": (1,)},
    )
    return SimpleNamespace(features=SimpleNamespace(evidence=evidence))


def shown(*errors: tuple[float, float, float]) -> Any:
    """Return models that are off by so much in the last test (arm, pressures), and by a tenth of it before."""
    measured = np.column_stack([MEASURED[name] for name in ("arm", "pressure1", "pressure2")])
    size = np.where(TIME < 0.8, 0.1, 1.0)[:, None]
    readings = {f"model {k}": measured + size * np.array(one) for k, one in enumerate(errors)}
    missing: Any = None
    return Shown(missing, readings, readings)


def test_the_channel_that_gains_most_in_the_test_that_is_worst() -> None:
    title, name, unit, time, measured, models = _worst_test(found(), shown((0.1, 4e3, 2e4), (0.09, 4e3, 1e3)))
    assert (title, name, unit) == ("worst test: ramp/2", "pressure 2", "Pa")
    assert np.array_equal(time, TIME[200:]) and np.array_equal(measured, MEASURED["pressure2"][200:])
    assert np.allclose([values - measured for _, values in models], [[2e4], [1e3]])


def test_the_arm_where_nothing_was_named() -> None:
    assert _worst_test(found(), shown((0.1, 4e3, 2e4)))[1] == "arm angle"
    [(name, (own, crossed))], repeated = _correlations(found(), shown((0.1, 4e3, 2e4)))
    assert name == "model 0" and len(own.values) == 51  # half of the shortest test
    assert crossed.name == "with the pump's angle before"
    assert [one.name for one in repeated] == [own.name, crossed.name]
    # chance makes more of the two of three tests that are repetitions
    assert repeated[0].band[0] == pytest.approx(own.band[0] * np.sqrt(3 / 2))
    once = found()
    once.features.evidence.conditions = {"up": (0,), "down": (1,), "level": (2,)}
    assert _correlations(once, shown((0.1, 4e3, 2e4)))[1] == []


def test_the_driver_is_what_the_quantity_depends_on(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(3)
    time, pressure, sign = np.linspace(0.0, 6.0, 900), random.uniform(1e5, 9e5, 900), np.sign(random.normal(size=900))
    drivers = {"time": time, "pressure_sum": pressure, "direction": sign, "repetition": sign}
    flow = SimpleNamespace(values=2e-15 * pressure + 1e-11 * random.normal(size=900), valid=np.ones(900, dtype=bool))
    monkeypatch.setattr(unexplained, "quantities", lambda features, seen: [None, None, flow, None])
    monkeypatch.setattr(unexplained, "driver_values", lambda features: drivers)
    fit: Any = SimpleNamespace(features=None)
    features: Any = None
    assert unexplained.driver_of(features, fit, "line_sum") == "pressure_sum"
    assert unexplained.driver_of(features, fit, "line_sum", ["pressure_sum"]) == "time"
