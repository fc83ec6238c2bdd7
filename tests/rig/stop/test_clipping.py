"""An output at the end of its range: it stops the test, and the log holds what was put out, not what was asked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_rig_limits import COUPLING, LIMITS, RANGE

from hjcamp import backends
from hjcamp.backends.recording import part_of, recording
from hjcamp.backends.rig.fault import RigFault
from hjcamp.errors import RigStopped
from hjcamp.plants.pump_joint.rig.control import COMMAND, PRELOAD_SPEED, RigControl
from hjcamp.plants.pump_joint.rig.limits import LimitCheck, read_limits
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log
from hjcamp.records.write import LogWriter

SEED = 42
SHORT = "rig.outputs.pump.highest_v=2.0"  # 500 deg; ramp_pos needs 1063
FREE = ("++rig.limits.output_clipped_ms=null", "rig.limits.tracking_deg=null")


def written(device: VirtualDevice, channel: str, samples: int) -> np.ndarray:
    """Return the volts on an output after each sample."""
    volts = np.zeros(samples + 1)
    for sample, name, value in device.written:
        if name == channel and sample <= samples:
            volts[sample:] = value
    return volts[1:]


def test_a_clipped_command_stops_the_test_and_the_log_says_what_was_put_out(
    compose: Any, device: VirtualDevice, tmp_path: Path
) -> None:
    path = tmp_path / "rep_01.mcap"

    def open_writer(place: Path, names: Any) -> LogWriter:
        return LogWriter(place, names, {}, {}, replace=True)

    with (
        pytest.raises(RigFault, match=r"output pump is clipped: 2\.0\d V asked, -10 to 2 V there"),
        recording(path, open_writer),
    ):
        backends.run_test(compose(SHORT), SEED)
    assert (device.volts["Dev1/ao1"], device.volts["Dev1/ao2"]) == (0.0, 0.0)
    held = device.volts["Dev1/ao0"] / 0.004
    assert abs(held - device.counts("pump") * 0.18) < 0.18  # the pump is held where it is
    columns = read_log(recover_log(part_of(path), tmp_path / "whole.mcap").path).columns
    assert columns["command_deg"].max() == pytest.approx(500.0)
    assert columns["command_deg"][-1] == pytest.approx(500.0)


def test_where_clipping_is_allowed_command_and_outputs_agree_and_no_encoder_is_accused(
    compose: Any, device: VirtualDevice
) -> None:
    columns, _ = backends.run_test(compose(SHORT, *FREE), SEED)
    put_out = written(device, "Dev1/ao0", len(columns["command_deg"]))
    np.testing.assert_allclose(columns["command_deg"] * 0.004, put_out, atol=1e-12)
    assert np.sum(columns["command_deg"] == columns["command_deg"].max()) > 100
    assert columns["pid_deg"].max() > 600.0  # what the law wanted is in its own columns


def test_a_voltage_drive_logs_the_command_that_gives_its_volts(compose: Any, device: VirtualDevice) -> None:
    lines = ("rig.outputs.pump.quantity=voltage", "+rig.outputs.pump.loop_v_per_deg=0.0278", "+rig.outputs.pump.sign=1")
    limits = ("rig.outputs.pump.safe_v=0.0", "rig.outputs.pump.highest_v=2.0", "rig.outputs.pump.lowest_v=-2.0")
    config = compose(*lines, *limits, *FREE, "rig.return_speed_mm_per_s=null")
    columns, _ = backends.run_test(config, SEED)
    volts = (columns["command_deg"] - columns["pump_deg"]) * 0.0278 + columns["dither_v"]
    np.testing.assert_allclose(volts, written(device, "Dev1/ao0", len(volts)), atol=1e-9)
    assert np.isclose(volts, 2.0).any()


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        (PRELOAD_SPEED, 6e-3, "output preload is clipped: 12.00 V asked, -10 to 10 V there"),
        (COMMAND, float("nan"), "the control law asks for nan rad"),
    ],
)
def test_other_outputs_and_no_number(
    compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, place: int, value: float, words: str
) -> None:
    step = RigControl.step

    def spoiled(self: RigControl, *arguments: float) -> Any:
        out = step(self, *arguments)
        if device.samples == 50:
            out[place] = value
        return out

    monkeypatch.setattr(RigControl, "step", spoiled)
    with pytest.raises(RigStopped) as caught:
        backends.run_test(compose(), SEED)
    assert words in str(caught.value)
    assert device.samples == 50
    assert all(np.isfinite(volts) for _, _, volts in device.written)
    assert device.volts["Dev1/ao1"] == 0.0


def test_the_limit_counts_samples(compose: Any) -> None:
    outputs, beyond = read_wiring(compose()).outputs, ("pump", 13.29)
    assert read_limits(compose()).output_clipped_ms == 0.0
    check = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    assert check.clipped(None, outputs) is None
    assert "13.29 V asked, -10 to 10 V there, limit output_clipped_ms 0 ms" in str(check.clipped(beyond, outputs))
    check = LimitCheck(replace(LIMITS, output_clipped_ms=3.0), 1e-3, RANGE, COUPLING)
    assert [check.clipped(beyond, outputs) for _ in range(3)] == [None] * 3
    assert check.clipped(None, outputs) is None  # counted anew
    assert [check.clipped(beyond, outputs) is None for _ in range(4)] == [True, True, True, False]
