"""Time that passes by itself: the plant goes on without its client, and the watchdog shows that it works."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from client_run import KINDS, PHASES, make_client_row

from hjcamp import backends
from hjcamp.errors import RigStopped, UsageError
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig.tasks import RigTasks
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault

TABLE = Path(__file__).parents[2] / "docs" / "rig_faults.md"
# Each kind once, in the phases in which most can go wrong; `make faults` makes all kinds in all phases.
ROWS = list(zip(KINDS, ("command", "release", "rest"), strict=True))
DITHER, PRELOAD, PUMP = "Dev1/ao2", "Dev1/ao1", "Dev1/ao0"


@pytest.fixture
def living(device: VirtualDevice, compose: Any) -> Iterator[VirtualDevice]:
    """A device whose time passes by itself, with a joint on it."""
    device.run_by_itself(1.0)
    device.arrange(compose(), 1)
    yield device
    device.close()


def opened(compose: Any) -> RigTasks:
    connection = rig_connection.connect(compose(), None)
    return RigTasks(read_wiring(compose()), connection, 0.1)


def test_time_passes_without_a_client(living: VirtualDevice) -> None:
    start = living.samples
    began = time.monotonic()
    while living.samples < start + 100:
        assert time.monotonic() < began + 30.0
        time.sleep(0.001)
    assert time.monotonic() - began > 0.08  # and no faster than the clock


def test_what_is_refused_leaves_the_rig_as_it_was(living: VirtualDevice, compose: Any) -> None:
    plant, config = living.plant, compose()
    config = {**config, "rig": {**config["rig"], "outputs": {}}}
    with pytest.raises(UsageError):
        living.arrange(config, 1)
    start = living.samples
    time.sleep(0.02)
    living.catch_up()
    assert living.plant is plant
    assert living.samples > start


def test_the_watchdog_ends_the_preload(living: VirtualDevice, compose: Any) -> None:
    tasks = opened(compose)
    tasks.read()
    tasks.write(0.05, 0.0, 0.0, 1e-3)
    assert (living.samples, PRELOAD, 2.0) in [(living.samples, *one[1:]) for one in living.written]
    before = living.volts[PUMP]
    time.sleep(0.05)
    living.catch_up()
    reset, tripped = living.trips[0]
    assert tripped - reset <= 5
    assert (living.volts[PRELOAD], living.volts[DITHER], living.volts[PUMP]) == (0.0, 0.0, before)
    # What a client that comes too late may still do: nothing, and it knows.
    assert tasks.make_safe(0.0) is None
    assert tasks.watchdog_was_first
    assert tasks.stands_at(0.0) == pytest.approx(0.05)
    tasks.close()


def test_without_a_watchdog_the_preload_goes_on(living: VirtualDevice, compose: Any) -> None:
    config = compose("rig.watchdog.enabled=false")
    tasks = RigTasks(read_wiring(config), rig_connection.connect(config, None), 0.1)
    tasks.read()
    tasks.write(0.0, 0.0, 0.0, 1e-3)
    time.sleep(0.05)
    living.catch_up()
    assert (living.volts[PRELOAD], living.trips) == (2.0, [])
    tasks.make_safe(0.0)
    tasks.close()


def test_reading_waits_for_the_clock_and_misses_what_has_passed(living: VirtualDevice, compose: Any) -> None:
    tasks = opened(compose)
    tasks.read()
    began, first = time.monotonic(), living.read_at
    for _ in range(50):
        tasks.read()
    assert time.monotonic() - began >= 0.045
    assert living.read_at - first >= 50
    time.sleep(0.03)
    assert tasks.read() >= 20
    tasks.close()


def test_a_whole_test(device: VirtualDevice, compose: Any) -> None:
    device.run_by_itself(0.1)
    lines = ("trajectory.amplitude_deg=6", "trajectory.duration=0.05", "trajectory.rise_time=0.05")
    patience = ("rig.limits.missed_at_once=20", "rig.limits.missed_in_all=200", "rig.watchdog.timeout_ms=20")
    columns, notes = backends.run_test(compose(*lines, *patience), 1)
    device.close()
    assert columns["phase"][-1] == 4.0
    assert np.allclose(np.diff(columns["time_s"]), 1e-3)
    assert int(notes["late_samples"]) <= 200
    assert device.trips == []
    assert (device.volts[PRELOAD], device.volts[DITHER]) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (Fault("device_gone", 60), "no longer present in the system"),
        (Fault("late_samples", 60), "samples were missed at once|watchdog timer expired"),
        (Fault("clock_stopped", 60), "error -200284"),
    ],
    ids=["device_gone", "late_samples", "clock_stopped"],
)
def test_faults(device: VirtualDevice, compose: Any, fault: Fault, words: str) -> None:
    device.faults = [fault]
    device.run_by_itself(0.1)
    with pytest.raises(RigStopped, match=words):
        backends.run_test(compose(), 1)
    device.close()
    assert (device.volts[PRELOAD], device.volts[DITHER]) == (0.0, 0.0)


def test_a_client_that_was_paused_stops(device: VirtualDevice, compose: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from hjcamp.plants.pump_joint.rig.control import RigControl

    device.run_by_itself(0.1)
    step = RigControl.step

    def paused(self: RigControl, *arguments: float) -> Any:
        if device.samples in range(50, 100) and not device.trips:
            time.sleep(0.2)  # 20 samples, between reading and writing
        return step(self, *arguments)

    monkeypatch.setattr(RigControl, "step", paused)
    with pytest.raises(RigStopped, match=r"made safe: writing failed: .*watchdog"):
        backends.run_test(compose(), 1)
    device.close()
    assert device.trips[0][1] - device.trips[0][0] <= 5


@pytest.mark.skipif(sys.platform == "win32", reason="SIGSTOP")
@pytest.mark.parametrize(("kind", "phase"), [pytest.param(*row, marks=pytest.mark.study) for row in ROWS])
def test_a_client_that_is_gone(kind: str, phase: str, tmp_path: Path, composer: Any, device: VirtualDevice) -> None:
    row = make_client_row(kind, phase, tmp_path, composer)
    assert any(line.startswith(row.line()) for line in TABLE.read_text(encoding="utf-8").splitlines()), row


def test_the_table_has_every_phase() -> None:
    text = TABLE.read_text(encoding="utf-8")
    assert not [(kind, phase) for kind in KINDS for phase in PHASES if f"| {kind} | {phase} |" not in text]
