"""Limits as data: each margin turns negative on the very sample at which the loop's own check makes the rig safe."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hjcamp import backends
from hjcamp.configuration.composer import Composer
from hjcamp.known_plants import find_plant
from hjcamp.live.describe import describe
from hjcamp.model.checks.watch import Term, Watch, plausible_watches
from hjcamp.plants.pump_joint.rig.limits import limit_check
from hjcamp.plants.pump_joint.rig.margins import rig_watches
from hjcamp.plants.pump_joint.rig.wiring import read_wiring

CALM = {
    "reference_deg": 0.0,
    "command_deg": 0.0,
    "arm_deg": 0.0,
    "pressure1_mpa": 0.26,
    "pressure2_mpa": 0.26,
    "pump_deg": 0.0,
}
# What goes too far, step by step of a sample, and the limit that must say so.
WALKS = {
    "pressure1_mpa": ({"pressure1_mpa": 0.01}, "pressure1_mpa"),
    "pressure2_mpa": ({"pressure2_mpa": -0.004, "pressure1_mpa": 0.004}, "pressure2_mpa"),
    "sum": ({"pressure1_mpa": -0.004, "pressure2_mpa": -0.003}, "pressure_sum_low_mpa"),
    "arm": ({"arm_deg": 1.0, "reference_deg": 1.0}, "arm_deg"),
    "arm speed": ({"arm_deg": 5.5, "reference_deg": 5.5}, "arm_speed_deg_per_s"),
    "tracking": ({"reference_deg": 0.3}, "tracking_deg"),
    "travel": ({"pump_deg": 10.0, "command_deg": 10.0}, "pump_travel_mm"),
    "pump speed": ({"pump_deg": -26.0, "command_deg": -26.0}, "pump_speed_mm_per_s"),
    "following": ({"command_deg": 24.0, "pump_deg": 10.0}, "pump_following_deg"),
}


@pytest.fixture(scope="module")
def composer() -> Composer:
    return Composer()


@pytest.fixture(scope="module")
def config(composer: Composer) -> dict[str, Any]:
    lines = [
        "backend=nidaqmx",
        "trajectory=ramp_pos",
        "rig.limits.pump_silent_deg=null",
        "rig.limits.arm_silent_mm=null",
    ]
    return composer.compose([*lines, "rig.limits.arm_silent_deg=null"]).config


@pytest.mark.parametrize("walk", WALKS)
def test_a_margin_ends_where_the_loop_stops(config: dict[str, Any], walk: str) -> None:
    steps, expected = WALKS[walk]
    count = 300
    columns = {name: value + np.arange(count) * steps.get(name, 0.0) for name, value in CALM.items()}
    columns |= {"phase": np.full(count, 3.0), "missed_samples": np.zeros(count)}
    check = limit_check(config, read_wiring(config))
    volts, out, stopped = np.full(2, 3.0), np.array([3.0, 0.0, 0.0]), None
    for k in range(count):
        angles = [np.radians(columns[name][k]) for name in ("arm_deg", "pump_deg")]
        pressures = [columns[name][k] * 1e6 for name in ("pressure1_mpa", "pressure2_mpa")]
        if check.check(0, volts, *pressures, *angles, out) is not None:
            stopped = k
            break
        out[1:3] = np.radians([columns[name][k] for name in ("reference_deg", "command_deg")])
    assert stopped is not None
    watches = {one.name: one for one in rig_watches(config)}
    watch = watches[expected]
    values = watch.values({name: one[: stopped + 1] for name, one in columns.items()})
    assert (watch.margin(values) or 0.0) < 0.0
    for one in watches.values():
        assert (one.margin(one.values({name: column[:stopped] for name, column in columns.items()})) or 0.0) >= -1e-9


def test_a_limit_counts_in_its_phases_alone() -> None:
    watch = Watch("sum", "MPa", (Term("a_mpa"),), low=0.2, phases=(2.0, 3.0))
    values = watch.values({"a_mpa": np.array([0.0, 0.5, 0.3, 0.1]), "phase": np.array([0.0, 2.0, 3.0, 4.0])})
    assert watch.margin(values) == pytest.approx(0.1)
    assert watch.margin(np.full(3, np.nan)) is None
    assert watch.values({"b_mpa": np.zeros(3)}).size == 0


def test_another_plant_brings_its_own_channels_and_limits() -> None:
    plant = find_plant("valve_joint", "here")
    told = describe({"plant": {"name": "valve_joint"}, "backend": {"name": "simulation"}})
    first = [one["name"] for one in told["channels"] if one["panel"] == ""]
    assert first == ["reference_deg", "arm_deg"]
    assert {one["panel"] for one in told["channels"]} == {"", "MPa", "1"}
    assert [one["name"] for one in told["watches"]] == ["arm_deg", "pressure1_mpa", "pressure2_mpa"]
    assert [one["label"] for one in told["watches"]] == ["arm angle", "line 1", "line 2"]
    limits = {one.name: (one.low, one.high) for one in plausible_watches(plant)}
    assert limits["arm_deg"] == pytest.approx((-360.0, 360.0))
    assert limits["pressure1_mpa"] == pytest.approx((-0.12, 2.0))
    assert told["period"] == plant.period


def test_a_simulated_test_is_seen_under_the_limits_of_its_rig(composer: Composer) -> None:
    config = composer.compose(["trajectory=ramp_pos"]).config
    assert "tracking_deg" in [one.name for one in backends.watches(config)]
    assert describe(config)["phases"]["3"] == "command and control"
