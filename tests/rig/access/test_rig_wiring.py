"""Scaling of terminals, and configurations that cannot be wired."""

from __future__ import annotations

import copy
from math import pi
from pathlib import Path
from typing import Any

import pytest

from hjcamp.configuration.check import check_configuration
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.check_stamp import require_check, write_stamp
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable
from hjcamp.plants.pump_joint.rig.park import note_parked, parked_at
from hjcamp.plants.pump_joint.rig.wiring import read_wiring


def test_scaling(compose: Any) -> None:
    wiring = read_wiring(compose())
    sensor = wiring.pressures["pressure1"]
    assert sensor.pascal(1.0) == pytest.approx(-0.101e6)
    assert sensor.pascal(sensor.volts(123456.0)) == pytest.approx(123456.0)
    assert wiring.encoders["arm"].count == pytest.approx(2 * pi / 1024)
    assert wiring.outputs["pump"].volts(pi) == pytest.approx(0.72)
    assert wiring.outputs["pump"].volts(1e6) == 10.0
    volts = {"Dev1/ao0": 0.72, "Dev1/ao1": 2.0, "Dev1/ao2": 1.2}
    assert wiring.physical_outputs(volts) == pytest.approx((pi, 1.2, 1e-3))


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("connection.kind", "usb", "rig.connection.kind is 'usb'; 'in_process' or 'address' or 'driver'"),
        ("connection.kind", "address", "kind=address needs an address"),
        ("inputs.arm.channel", "Dev1/ctr1", "Dev1/ctr1 is used twice"),
        ("inputs.arm.channel", None, "rig.inputs.arm.channel is null"),
        ("inputs.arm.sign", 2, "-1 or 1 is needed"),
        ("inputs.pump.pulses_per_turn", 512, "2048 counts a turn"),
        ("inputs.pressure1.mpa_per_v", 0.0, "a slope other than 0"),
        ("inputs.pressure1.lowest_v", "low", "a number from"),
        ("inputs.pressure1.lowest_v", 99.0, "lowest_v must be below highest_v"),
        ("outputs.pump.quantity", "speed", "'position' or 'voltage'"),
        ("outputs.pump.safe_v", 0.0, "rig.outputs.pump.safe_v is 0.0; hold, at which its drive stands still,"),
        ("outputs.preload.safe_v", "hold", "rig.outputs.preload.safe_v is 'hold'; 0, at which its drive stands still,"),
        ("outputs.preload.safe_v", 10.0, "rig.outputs.preload.safe_v is 10.0; 0, at which"),
        ("outputs.preload.lowest_v", 0.5, "lowest_v <= safe_v <= highest_v"),
        ("outputs.dither.safe_v", -1.0, "rig.outputs.dither.safe_v is -1.0; 0, at which"),
        ("outputs.pump.v_per_deg", 0.0, "rig.outputs.pump.v_per_deg is 0.0; a scale other than 0"),
        (
            "outputs.pump.v_per_deg",
            1e-12,
            "a scale other than 0, of 1e-05 or more either way (with less nothing moves), is needed",
        ),
        ("outputs.preload.v_per_mm_per_s", -9e-6, "a scale other than 0, of 1e-05 or more"),
        ("outputs.dither.v_per_v", 1e-300, "a scale other than 0, of 1e-05 or more"),
        ("inputs.pressure2.mpa_per_v", -1e-9, "a slope other than 0, of 1e-05 or more"),
        ("outputs.pump.v_per_deg", None, "rig.outputs.pump.v_per_deg is null; a number"),
        ("outputs", None, "rig.outputs is null; a mapping of pump, preload, dither is needed"),
        ("watchdog", True, "rig.watchdog is true; a mapping of enabled, timeout_ms"),
        ("watchdog.timeout_ms", 0, "from 2 to 100"),
        ("watchdog.timeout_ms", 1e9, "from 2 to 100"),
        ("watchdog.timeout_ms", -5, "from 2 to 100"),
    ],
)
def test_refused(compose: Any, path: str, value: Any, words: str) -> None:
    config = copy.deepcopy(compose())
    place = config["rig"]
    *parents, last = path.split(".")
    for part in parents:
        place = place[part]
    place[last] = value
    with pytest.raises(UsageError) as caught:
        read_wiring(config)
    assert words in str(caught.value)


def test_a_rig_that_is_not_wired_can_only_be_simulated(compose: Any) -> None:
    config = compose()
    bare = {**config, "rig": {key: config["rig"][key] for key in ("name", "sensors", "scatter")}}
    check_configuration({**bare, "backend": {"name": "simulation"}})
    with pytest.raises(UsageError, match=r"rig\.connection is missing"):
        check_configuration(bare)


def test_a_voltage_drive_is_safe_at_zero_volts(compose: Any) -> None:
    config = compose("rig=example_pxie")
    assert read_wiring(config).outputs["pump"].safe_v == 0.0
    with pytest.raises(UsageError, match=r"pump\.safe_v is 'hold'; 0, at which"):
        read_wiring(compose("rig=example_pxie", "rig.outputs.pump.safe_v=hold"))


@pytest.mark.parametrize(
    "change",
    [
        "rig.outputs.pump.v_per_deg=-0.004",
        "rig.outputs.preload.v_per_mm_per_s=3",
        "rig.inputs.arm.sign=-1",
        "rig.inputs.pressure1.mpa_at_0v=0",
        "rig.limits.pump_travel_mm=7",
        "rig.watchdog.enabled=true",
        "rig.watchdog.timeout_ms=20",
        "rig.output_timing=hardware_timed",
        "pump.lead_mm_per_rev=2",
        "amplifier.command_deg_per_v=30",
    ],
)
def test_a_change_of_wiring_scale_or_limits_makes_the_check_void(
    compose: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    write_stamp(compose("rig=example_pcie"), {})
    require_check(compose("rig=example_pcie", "seed=2", "controller.positive.kp=1.1"))
    with pytest.raises(RigUnavailable, match="was not checked as it is configured now"):
        require_check(compose("rig=example_pcie", change))


def test_the_place_of_a_parked_pump_outlives_a_change_of_limits(
    compose: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    config = compose("rig=example_pcie")
    note_parked(config, read_wiring(config), 2.5)
    changed = compose("rig=example_pcie", "rig.limits.pump_travel_mm=7", "pump.lead_mm_per_rev=2")
    assert parked_at(changed, read_wiring(changed)) == 2.5
