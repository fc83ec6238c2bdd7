"""The virtual rig against the simulator: equal seeds give equal tests, through the vendor's client code."""

from __future__ import annotations

import gc
from typing import Any

import numpy as np
import pytest
from plain_kernel import plain

from hjcamp import backends
from hjcamp.errors import RigStopped
from hjcamp.plants.pump_joint.rig import park as rig_park
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.virtual_rig import plant as virtual_plant
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault
from hjcamp.plants.pump_joint.virtual_rig.plant import READINGS

SEED = 42
CONDITIONS = (
    ("trajectory=ramp_pos",),
    pytest.param(
        ("trajectory=cycloid_neg", "controller=ffwd_pid", "payload=brass_8p5g", "orientation=vertical"),
        marks=pytest.mark.study,
    ),
)


@pytest.mark.parametrize("lines", CONDITIONS, ids=["plain", "payload"])
def test_equal_to_the_simulation(compose: Any, device: VirtualDevice, lines: tuple[str, ...]) -> None:
    simulated, _ = backends.run_test(compose(*lines, "backend=simulation"), SEED)
    measured, notes = backends.run_test(compose(*lines), SEED)
    assert set(measured) == set(simulated)
    for name in ("time_s", "phase", "reference_deg", "command_deg", "pid_deg", "feedforward_deg", "dither_v"):
        np.testing.assert_array_equal(measured[name], simulated[name], err_msg=name)
    for name in ("arm_deg", "pump_deg"):
        np.testing.assert_array_equal(measured[name], simulated[name], err_msg=name)
    for name in ("pressure1_mpa", "pressure2_mpa"):
        np.testing.assert_allclose(measured[name], simulated[name], rtol=0, atol=1e-12, err_msg=name)
    assert notes["late_samples"] == "0"
    assert notes["devices"].startswith("Dev1 Virtual-6363")


def test_seeds_differ(compose: Any, device: VirtualDevice) -> None:
    first, _ = backends.run_test(compose(), 1)
    second, _ = backends.run_test(compose(), 2)
    assert not np.array_equal(first["command_deg"][:500], second["command_deg"][:500])


def test_hidden_effect_is_the_rigs_own(compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    # sixty samples of the preload in plain Python: a kernel with an effect would be compiled for this test alone
    monkeypatch.setattr(virtual_plant, "load_model", plain)

    def preloaded() -> np.ndarray:
        device.arrange(compose(), SEED)
        assert device.plant is not None
        return np.array([device.plant.advance(np.array([0.0, 0.0, 1e-3])).copy() for _ in range(60)])

    whole = preloaded()
    assert np.array_equal(preloaded(), whole)
    device.hidden = {"leakage": {}}
    leaky = preloaded()
    pressures = [READINGS.index("pressure1_mpa"), READINGS.index("pressure2_mpa")]
    lost = (whole - leaky)[:, pressures]
    # the noise is that of the same seed, so what is left is the leak: nothing at first, then more and more
    assert np.all(np.diff(lost[1:], axis=0) > 0.0) and np.all(lost[-1] > 1.0)


def test_voltage_drive_closes_the_loop_here(compose: Any, device: VirtualDevice) -> None:
    lines = ("+rig.outputs.pump.loop_v_per_deg=0.0278", "+rig.outputs.pump.sign=1", "rig.outputs.pump.safe_v=0.0")
    config = compose("rig.outputs.pump.quantity=voltage", *lines, "rig.limits.tracking_deg=100")
    columns, _ = backends.run_test(config, SEED)
    moving = columns["phase"] == 3.0
    behind = np.abs(columns["command_deg"] - columns["pump_deg"])[moving]
    assert columns["pump_deg"].max() > 360.0  # the motor really went where it was sent
    assert np.median(behind) < 120.0


def test_a_parked_pump_comes_back_slowly(compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rig_park, "keeps_its_place", lambda config, wiring: True)
    config = compose()
    wiring = read_wiring(config)
    rig_park.note_parked(config, wiring, -1.0)
    backends.run_test(config, SEED)
    pump = [(sample, volts) for sample, channel, volts in device.written if channel == "Dev1/ao0"]
    slope = wiring.outputs["pump"].volts_per_unit
    assert pump[0] == (0, pytest.approx(-slope))
    step = 10.0 * 2 * np.pi * 1e-3 * slope  # 10 mm/s in one sample
    first = [volts for sample, volts in pump if sample <= 16]
    assert np.abs(np.diff(first)).max() <= step * 1.001
    assert first[-1] == 0.0
    assert abs(rig_park.parked_at(config, wiring)) < 0.2  # it went back at the end
    rig_park.note_parked(config, wiring, None)  # as a killed test leaves it
    with pytest.raises(RigUnavailable, match="bring it to its start by hand"):
        backends.run_test(config, SEED)


@pytest.mark.parametrize("fault", ["late_samples", "lost_sensor"])
def test_where_a_stopped_pump_stands(compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, fault: str) -> None:
    monkeypatch.setattr(rig_park, "keeps_its_place", lambda config, wiring: True)
    device.faults = [Fault(fault, 1000)]
    config = compose()
    with pytest.raises(RigStopped):
        backends.run_test(config, SEED)
    wiring = read_wiring(config)
    # Held at its last command where the watchdog was first, otherwise where it was measured: in both what it was told.
    held = device.volts["Dev1/ao0"] / wiring.outputs["pump"].volts_per_unit
    measured = device.counts("pump") * wiring.encoders["pump"].count
    assert rig_park.parked_at(config, wiring) == pytest.approx(held)
    assert (abs(held - measured) > 0.2) == (fault == "late_samples")


def test_nobody_knows_where_a_pump_stands_that_could_not_be_told(
    compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_park, "keeps_its_place", lambda config, wiring: True)
    device.faults = [Fault("device_gone", 1000)]
    config = compose()
    with pytest.raises(RigStopped, match="COULD NOT BE WRITTEN"):
        backends.run_test(config, SEED)
    with pytest.raises(RigUnavailable, match="could not write its outputs"):
        rig_park.parked_at(config, read_wiring(config))


def test_a_late_sample_is_counted_and_held(compose: Any, device: VirtualDevice) -> None:
    device.faults = [Fault("one_late_sample", 1000)]
    columns, notes = backends.run_test(compose(), SEED)
    assert notes["late_samples"] == "1"
    assert "2-3ms:1" in notes["cycle_times"]
    np.testing.assert_allclose(np.diff(columns["time_s"]), 1e-3, atol=1e-9)
    held = 1000
    assert columns["arm_deg"][held] == columns["arm_deg"][held - 1]
    assert columns["time_s"][columns["phase"] == 3.0][0] == 0.0


def test_outputs_are_written_through_the_watchdog(compose: Any, device: VirtualDevice) -> None:
    backends.run_test(compose(), SEED)
    assert device.samples > 1500
    # The preload stands still and the dither is off when the test has ended.
    assert device.volts["Dev1/ao1"] == 0.0
    assert device.volts["Dev1/ao2"] == 0.0


def test_tasks_are_cleared(compose: Any, device: VirtualDevice) -> None:
    backends.run_test(compose(), SEED)
    assert device.tasks._tasks == {}
    gc.collect()  # a task that was not closed would warn here
