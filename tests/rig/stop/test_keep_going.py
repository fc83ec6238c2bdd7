"""``--keep-going`` and ``--fail-fast`` on the virtual rig: what a fault of one test means for those after it."""

from __future__ import annotations

import io
import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from hjcamp import cli
from hjcamp.campaign.execution.stop_rule import StopRule
from hjcamp.campaign.files.run_folder import RunFolder, folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import RunResult, run_plan
from hjcamp.errors import RigStopped
from hjcamp.plants.pump_joint.rig.control import RigControl
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log

SHORT = ("trajectory=ramp_pos", "trajectory.amplitude_deg=20", "trajectory.duration=0.4", "trajectory.rise_time=0.2")
LINES = ("backend=nidaqmx", *SHORT, "repetitions=2")
GO_ON = StopRule(keep_going=True)


def start(composer: Any, *lines: str) -> RunFolder:
    given = [*LINES, *lines]
    return folder_for(make_plan(composer.compose(given).config, None, given, composer), {}, [], Path("run"))[0]


def run(folder: RunFolder, rule: StopRule, said: list[str]) -> RunResult:
    return run_plan(folder, Console(file=io.StringIO()), rule=rule, announce=said.append)


def test_by_default_a_rig_that_was_made_safe_ends_the_run(composer: Any, device: VirtualDevice) -> None:
    device.faults = [Fault("late_samples", 300, 1)]
    with pytest.raises(RigStopped, match="2 tests left"):
        run(start(composer), StopRule(), [])
    assert device.tests == 1


@pytest.mark.parametrize(("kinds", "same"), [(("late_samples", "late_samples"), True), (("late_samples", "arm_jump"), False)])
def test_a_test_that_stops_again_at_the_same_limit_is_named_with_the_way_on(
    composer: Any, device: VirtualDevice, kinds: tuple[str, str], same: bool
) -> None:
    folder = start(composer)
    device.faults = [Fault(kinds[0], 700, 1)]
    with pytest.raises(RigStopped) as first:
        run(folder, StopRule(), [])
    assert "same limit before" not in str(first.value) and str(first.value).endswith("go on with: hjcamp resume run")
    device.faults = [Fault(kinds[1], 650, device.tests + 2)]
    with pytest.raises(RigStopped) as again:
        run(open_folder(folder.path), StopRule(), [])
    assert "1 test left; go on with: hjcamp resume run" in str(again.value)
    words = "ramp_pos__pid/rep_01 was stopped by the same limit before; without it: hjcamp report run"
    assert (words in str(again.value)) is same
    device.faults = [Fault(kinds[1], 650, device.tests + 1)]
    with pytest.raises(RigStopped, match="same limit before"):
        run(open_folder(folder.path), StopRule(), [])
    # the test that was stopped did not keep the other from being made
    states = {test: entry["state"] for test, entry in open_folder(folder.path).manifest["tests"].items()}
    assert states == {"ramp_pos__pid/rep_01": "failed", "ramp_pos__pid/rep_02": "done"}


@pytest.mark.parametrize(("kind", "sample"), [("late_samples", 20), ("late_samples", 700), ("arm_jump", 700)])
def test_keep_going_looks_at_the_rig_and_goes_on(
    composer: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, kind: str, sample: int
) -> None:
    device.faults = [Fault(kind, sample, 1)]
    if kind != "late_samples":  # a loose contact: gone when the rig is looked at
        make_safe = "hjcamp.plants.pump_joint.rig.tasks.RigTasks.make_safe"
        from hjcamp.plants.pump_joint.rig.tasks import RigTasks

        real = RigTasks.make_safe

        def mended(self: RigTasks, motor: float) -> str | None:
            device.faults = []
            return real(self, motor)

        monkeypatch.setattr(make_safe, mended)
    said: list[str] = []
    result = run(folder := start(composer), GO_ON, said)
    assert (result.done, len(result.failures), result.made_safe) == (1, 1, 1)
    assert "looked at again (at rest:" in said[0] and "going on" in said[0]
    assert "lines released" in said[0]
    assert folder.manifest["state"] == "failed"
    assert run(folder, GO_ON, said).done == 1
    assert folder.manifest["state"] == "complete"


@pytest.mark.parametrize(
    ("kind", "sample", "words"),
    [
        ("lost_sensor", 700, "sensor 1 is lost"),
        ("burst_line", 700, "not fit to go on"),
        ("burst_line", 300, "not fit to go on"),
        ("noisy_sensor", 700, "not fit to go on"),
        ("device_gone", 700, "COULD NOT BE WRITTEN"),
        ("error_code", 700, "memory overflow"),
        ("stuck_pump_encoder", 20, "the pump encoder is silent"),
        ("stuck_pump_encoder", 700, "not fit to go on"),
        ("stuck_encoder", 700, "not fit to go on"),
    ],
)
def test_a_rig_that_is_not_fit_is_left_alone(composer: Any, device: VirtualDevice, kind: str, sample: int, words: str) -> None:
    device.faults = [Fault(kind, sample)]
    with pytest.raises(RigStopped) as caught:
        run(start(composer), GO_ON, [])
    assert words in str(caught.value)
    assert device.tests == 1
    assert (device.volts["Dev1/ao1"], device.volts["Dev1/ao2"]) == (0.0, 0.0)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_who_asks_to_stop_is_obeyed(composer: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    step = RigControl.step

    def interrupted(self: RigControl, *arguments: float) -> Any:
        if device.samples == 400:
            os.kill(os.getpid(), number)
            os.kill(os.getpid(), number)
        return step(self, *arguments)

    monkeypatch.setattr(RigControl, "step", interrupted)
    with pytest.raises(RigStopped, match=r"SIGTERM|Ctrl-C"):
        run(start(composer), GO_ON, [])
    assert device.tests == 1


def test_the_commands(device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    device.faults = [Fault("late_samples", 300, 1)]
    assert cli.run(["run", *LINES, "--keep-going", "run_dir=one"]) == 3
    out, err = capsys.readouterr()
    assert "1 failed" in out and "1 to go: hjcamp resume one" in err
    device.faults = [Fault("late_samples", 300, device.tests + 1)]
    assert cli.run(["resume", "one", "--keep-going"]) == 3
    assert cli.run(["resume", "one"]) == 0
    device.faults = [Fault("late_samples", 300)]
    assert cli.run(["run", *LINES, "--fail-fast", "run_dir=two"]) == 3
    for command in (["run", *LINES, "run_dir=three"], ["resume", "two"]):
        capsys.readouterr()
        assert cli.run([*command, "--keep-going", "--fail-fast"]) == 2
        assert "give one of them" in capsys.readouterr().err
    assert not Path("three").exists()


def test_serials_host_and_calibration_are_in_every_log(composer: Any, device: VirtualDevice, tmp_path: Path) -> None:
    device.faults = [Fault("late_samples", 700, 1)]
    folder = start(composer)
    run(folder, GO_ON, [])
    recover_log(next(folder.path.rglob("*.mcap.part")), tmp_path / "recovered.mcap")
    session = json.loads((folder.path / "manifest.json").read_text())["sessions"][0]
    whole = next(folder.path.rglob("rep_02.mcap"))
    for facts in (read_log(whole).metadata, read_log(tmp_path / "recovered.mcap").metadata, session["rig"]):
        assert facts["devices"].startswith("Dev1 Virtual-6363 ")
        assert facts["calibration"] == "virtual"
        assert facts["host"] == session["host"]
