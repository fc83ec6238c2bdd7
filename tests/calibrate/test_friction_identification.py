"""Friction of both directions from strokes at several speeds, read through an encoder of 0.35 deg."""

from __future__ import annotations

import numpy as np
import pytest
from identification_logs import COUNT, counted, friction_log, make

from hjcamp.configuration.setups import configuration_for
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.constants import constants_of
from hjcamp.plants.pump_joint.calibrate.friction import identify_friction
from hjcamp.plants.pump_joint.calibrate.sensors import identify_sensors, pressure_noise, smallest_step
from hjcamp.plants.pump_joint.calibrate.strokes import find_strokes

SPEEDS = (0.0025, 0.01, 0.03, 0.06)


def test_friction_is_found_with_intervals() -> None:
    logs = [friction_log(speed, seed=seed) for speed in SPEEDS for seed in range(3)]
    found = identify_friction(logs, constants_of(logs[0], configuration_for))
    for side in ("positive", "negative"):
        for name, truth, share in (("static", 7.2, 0.02), ("coulomb", 5.27, 0.02), ("viscous", 23.5, 0.1)):
            one = found[f"{name}_{side}"]
            assert one.value == pytest.approx(truth, rel=share)
            assert one.interval is not None and one.interval[0] < one.value < one.interval[1]
    assert [chart.figure for chart in found.charts] == ["4.5.3, A.1", "4.5.3, A.2", "4.5.1"]


def test_one_repetition_gives_values_without_intervals_and_says_so() -> None:
    logs = [friction_log(speed) for speed in SPEEDS]
    found = identify_friction(logs, constants_of(logs[0], configuration_for))
    assert all(one.interval is None for one in found.estimates)
    assert any("one repetition only" in text for text in found.warnings)


def test_too_few_speeds_are_refused() -> None:
    logs = [friction_log(speed, seed=seed) for speed in SPEEDS[:2] for seed in range(2)]
    with pytest.raises(UsageError, match=r"too few speeds.*2 where 3"):
        identify_friction(logs, constants_of(logs[0], configuration_for))


def test_no_constant_speed_is_refused() -> None:
    log = friction_log(0.01)
    time = log.columns["time_s"]
    swinging = make({**log.columns, "command_deg": 900.0 * np.sin(2 * np.pi * time)})
    with pytest.raises(UsageError, match="no constant-speed segment"):
        identify_friction([swinging], constants_of(log, configuration_for))


def test_stick_and_slip_is_no_constant_speed() -> None:
    logs = []
    for speed in SPEEDS:
        log = friction_log(speed)
        whole, part = np.divmod(log.columns["arm_deg"], 8.0)
        arm = 8.0 * (whole + np.clip(4.0 * part / 8.0 - 3.0, 0.0, 1.0))
        logs.append(make({**log.columns, "arm_deg": counted(arm, COUNT)}))
    with pytest.raises(UsageError, match=r"too few speeds.*sticks and slips"):
        identify_friction(logs, constants_of(logs[0], configuration_for))


def test_strokes_are_the_straight_parts() -> None:
    time = np.arange(3000) * 1e-3
    triangle = 300.0 * (2.0 / np.pi) * np.arcsin(np.sin(np.pi * time))
    found = find_strokes(np.floor(triangle / 0.18) * 0.18)
    assert [one.direction for one in found] == [1.0, -1.0, 1.0, -1.0]
    assert all(abs(one.speed) == pytest.approx(600.0, rel=0.01) for one in found)
    assert find_strokes(300.0 * np.sin(2 * np.pi * time)) == []


def test_sensors() -> None:
    generator = np.random.default_rng(3)
    ramp = np.linspace(0.0, 0.5, 4000)
    assert pressure_noise(ramp + generator.normal(0.0, 7e-4, 4000)) == pytest.approx(7e-4, rel=0.06)
    assert smallest_step(np.floor(ramp * 100 / 0.3515625) * 0.3515625) == pytest.approx(0.3515625)
    assert smallest_step(ramp + generator.normal(0.0, 7e-4, 4000)) is None
    logs = [friction_log(0.01, seed=seed) for seed in range(3)]
    found = identify_sensors(logs)
    assert found["pressure_noise"].value == pytest.approx(700.0, rel=0.1)
    assert np.degrees(found["encoder_count"].value) == pytest.approx(360 / 1024)
    assert any("offsets of the pressure sensors" in text for text in found.warnings)
    open_lines = {**logs[0].columns, "pressure1_mpa": np.full(len(logs[0].columns["time_s"]), 0.004)}
    open_lines["pressure2_mpa"] = -0.5 * open_lines["pressure1_mpa"]
    assert identify_sensors([make(open_lines)])["pressure2_offset"].value == pytest.approx(-2000.0)
