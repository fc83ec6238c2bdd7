"""A driver that cannot brake its motor; its model has a winding through which current flows both ways."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from wheel_plant import DRIVER, diagnosed

from hjcamp.records.log import TestLog

PERIOD, STEPS, SAMPLES = 2e-3, 20, 2400


def measured_log(forward_only: bool, seed: int) -> TestLog:
    """Return a test of a motor under steps of voltage, through a diode with a bent characteristic or without."""
    generator = np.random.default_rng(seed)
    voltage = np.repeat(generator.uniform(0.0, 5.0, SAMPLES // 60 + 1), 60)[:SAMPLES]
    speed, found = 0.0, np.empty(SAMPLES)
    for k in range(SAMPLES):
        found[k] = speed
        for _ in range(STEPS):
            current = (voltage[k] - 5e-3 * speed) / 2.0
            if forward_only:
                current = 0.02 * np.log1p(np.exp(min(current / 0.02, 50.0))) if current < 1.0 else current
            speed += PERIOD / STEPS * (5e-3 * current - 6e-6 * speed) / 1e-5
    rpm = 30.0 / np.pi * found + generator.normal(scale=2.0, size=SAMPLES)
    columns = {"time_s": np.arange(SAMPLES) * PERIOD, "voltage_v": voltage, "speed_rpm": rpm}
    return TestLog(columns, {"plant": "driver", "period_s": str(PERIOD), "condition": f"steps{seed}"})


@pytest.mark.parametrize("forward_only", [True, False])
def test_a_driver_that_cannot_brake_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forward_only: bool) -> None:
    monkeypatch.chdir(tmp_path)
    found = diagnosed(DRIVER, measured_log(forward_only, 4), ("check_valve", "dead_band", "quadratic_drag", "sensor_offset"))
    if not forward_only:
        assert (found["verdict"], found["effects"]) == ("nothing_missing", [])
        return
    assert (found["verdict"], found["effects"]) == ("effect", ["check_valve"])
    [row] = [one for one in found["candidates"] if one["effect"] == "check_valve"]
    assert row["parameters"]["blocked"]["value"] > 0.95
