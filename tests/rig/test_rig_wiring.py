"""Scaling of terminals, and configurations that cannot be wired."""

from __future__ import annotations

import copy
from math import pi
from typing import Any

import pytest

from hjcamp.backends import check_test
from hjcamp.backends.rig_wiring import read_wiring
from hjcamp.errors import UsageError


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


@pytest.mark.parametrize("rig", ["example_pcie", "example_pxie"])
def test_the_examples_are_whole(compose: Any, rig: str) -> None:
    check_test(compose(f"rig={rig}"))


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("connection.kind", "usb", "Allowed: address, driver, in_process"),
        ("inputs.arm.channel", "Dev1/ctr1", "Dev1/ctr1 is used twice"),
        ("inputs.arm.channel", None, "'arm' has no channel"),
        ("inputs.arm.sign", 2, "sign is 1 or -1"),
        ("inputs.pump.pulses_per_turn", 512, "2048 counts a turn"),
        ("inputs.pressure1.mpa_per_v", 0.0, "mpa_per_v is 0"),
        ("inputs.pressure1.lowest_v", "low", "a number is needed"),
        ("outputs.pump.quantity", "speed", "Allowed: position, voltage"),
        ("outputs.preload.safe_v", "hold", "only a pump drive that takes a position can hold"),
        ("outputs.preload.safe_v", 11.0, "lowest_v <= safe_v <= highest_v"),
        ("outputs.pump.v_per_deg", 0.0, "must not be 0"),
        ("outputs", None, "'outputs' is missing"),
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
        check_test(config)
    assert words in str(caught.value)
    assert "rig 'virtual'" in str(caught.value)
