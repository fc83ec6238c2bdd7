"""A log of a rig says when it was made; a log of the simulator does not, so equal tests are equal files."""

from __future__ import annotations

import io
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from rich.console import Console

from hjcamp.campaign.files.run_folder import RunFolder, folder_for
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.errors import RigStopped
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log

SHORT = ("trajectory=ramp_pos", "trajectory.amplitude_deg=20", "trajectory.duration=0.4", "trajectory.rise_time=0.2")


def run(composer: Any, backend: str, place: str) -> RunFolder:
    lines = [*SHORT, f"backend={backend}", "repetitions=2"]
    folder = folder_for(make_plan(composer.compose(lines).config, None, lines, composer), {}, [], Path(place))[0]
    run_plan(folder, Console(file=io.StringIO()))
    return folder


def test_a_rigs_log_begins_when_it_was_made(composer: Any, device: VirtualDevice) -> None:
    before = datetime.now(UTC) - timedelta(milliseconds=1)
    folder = run(composer, "nidaqmx", "rig")
    after = datetime.now(UTC)
    moments = []
    for path in sorted(folder.path.rglob("*.mcap")):
        started = datetime.fromisoformat(read_log(path).metadata["started_at"])
        assert started.utcoffset() == timedelta(0)
        with path.open("rb") as stream:
            times = [message.log_time for _, _, message in make_reader(stream).iter_messages()]
        assert times[0] == round(started.timestamp() * 1e3) * 10**6  # the contract: log_time is the time of the sample
        assert times[1] - times[0] == 10**6
        moments.append(started)
    assert before < moments[0] < moments[1] < after
    assert "started_at" not in folder.manifest["sessions"][0]["rig"]


def test_so_does_what_a_stopped_test_left(composer: Any, device: VirtualDevice, tmp_path: Path) -> None:
    device.faults = [Fault("late_samples", 700)]
    with pytest.raises(RigStopped):
        run(composer, "nidaqmx", "rig")
    recovered = recover_log(next(Path("rig").rglob("*.mcap.part")), tmp_path / "recovered.mcap")
    started = datetime.fromisoformat(read_log(recovered.path).metadata["started_at"])
    assert abs(datetime.now(UTC) - started) < timedelta(minutes=5)


def test_a_simulated_log_knows_no_time(composer: Any, device: VirtualDevice) -> None:
    one, two = run(composer, "simulation", "one"), run(composer, "simulation", "two")
    logs = sorted(path.relative_to(one.path) for path in one.path.rglob("*.mcap"))
    assert len(logs) == 2
    for log in logs:
        assert (one.path / log).read_bytes() == (two.path / log).read_bytes()
        assert "started_at" not in read_log(one.path / log).metadata
