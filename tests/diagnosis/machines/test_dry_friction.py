"""A motor that rubs dry, or that its own voltage brakes; its model has the other friction alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from wheel_plant import DRY_WHEEL, WHEEL, diagnosed

from hjcamp.records.log import TestLog

PERIOD, STEPS = 2e-3, 40


def measured_log(dry: float, samples: int = 1500, viscous: float = 1.5e-4, plant: str = "wheel") -> TestLog:
    """Return a test of a motor with dry friction (N m): steps of voltage, small steps of time, and rest where it sticks."""
    generator = np.random.default_rng(8)
    voltage = np.repeat(generator.uniform(-4.0, 4.0, samples // 50 + 1), 50)[:samples]
    speed, found = 0.0, np.empty(samples)
    for k in range(samples):
        found[k] = speed
        for _ in range(STEPS):
            torque = 2e-3 * voltage[k] - viscous * speed
            moved = speed + PERIOD / STEPS * (torque - dry * np.sign(speed or torque)) / 1e-5
            # it stays where it is once the push is less than what holds it
            speed = 0.0 if (speed * moved <= 0.0 and abs(2e-3 * voltage[k]) <= dry) else moved
    rpm = 30.0 / np.pi * found + generator.normal(scale=2.0, size=samples)
    columns = {"time_s": np.arange(samples) * PERIOD, "voltage_v": voltage, "speed_rpm": rpm}
    return TestLog(columns, {"plant": plant, "period_s": str(PERIOD), "condition": "steps"})


@pytest.mark.study
@pytest.mark.parametrize(
    ("dry", "samples"),
    [(1.2e-3, 1500), (0.0, 1500), (1.2e-3, 6000)],
)
def test_dry_friction_is_named_where_the_model_has_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, dry: float, samples: int
) -> None:
    monkeypatch.chdir(tmp_path)
    names = ("command_delay", "dead_band", "dry_friction", "quadratic_drag", "sensor_lag", "sensor_offset")
    found = diagnosed(WHEEL, measured_log(dry, samples), names)
    # short tests are simulated through, long ones over windows
    assert found["simulated_through"] == (samples == 1500)
    if not dry:
        assert (found["verdict"], found["effects"]) == ("nothing_missing", [])
        return
    assert found["verdict"] in ("effect", "one_of") and found["effects"][0] == "dry_friction"
    [row] = [one for one in found["candidates"] if one["effect"] == "dry_friction"]
    assert row["parameters"]["level"]["value"] == pytest.approx(dry, rel=0.1)


@pytest.mark.parametrize("viscous", [1.0e-4, 0.0])
def test_viscous_friction_is_named_where_the_model_has_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, viscous: float
) -> None:
    monkeypatch.chdir(tmp_path)
    names = ("command_delay", "dead_band", "viscous_friction", "quadratic_drag", "sensor_lag", "sensor_offset")
    found = diagnosed(DRY_WHEEL, measured_log(1.5e-3, 3000, viscous, "dry_wheel"), names)
    if not viscous:
        assert (found["verdict"], found["effects"]) == ("nothing_missing", [])
        return
    assert (found["verdict"], found["effects"]) == ("effect", ["viscous_friction"])
    [row] = [one for one in found["candidates"] if one["effect"] == "viscous_friction"]
    assert row["parameters"]["coefficient"]["value"] == pytest.approx(viscous, rel=0.05)
