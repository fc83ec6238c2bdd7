"""Who may use a rig, and when: the lock, the check, a missing driver, another client, signals."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hjcamp import backends, cli
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig import lock as rig_lock
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault, parse_fault
from hjcamp.plants.pump_joint.virtual_rig.server import check_address, start_server

HOLDER = """
import sys, time
from pathlib import Path
from hjcamp.plants.pump_joint.rig import lock as rig_lock
config = {"rig": {"connection": {"kind": "address", "address": "localhost:1"}}, "amplifier": {}}
rig_lock.lock_folder = lambda: Path(sys.argv[1])
rig_lock.rig_identity = lambda config: "the test rig"
rig_lock.take_lock(config)
print("held", flush=True)
time.sleep(60)
"""


@pytest.fixture
def holder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Another process that holds the lock of "the test rig"."""
    monkeypatch.setattr(rig_lock, "rig_identity", lambda config: "the test rig")
    monkeypatch.setattr(rig_lock, "lock_folder", lambda: tmp_path)
    monkeypatch.setattr("hjcamp.backends.rig.lock.lock_folder", lambda: tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(Path(rig_lock.__file__).parents[3])}
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.wait()
    process.stdout.close()
    rig_lock.release_locks()


def test_the_second_run_is_refused_until_the_first_dies(
    holder: subprocess.Popen[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(RigUnavailable, match=f"in use by process {holder.pid}"):
        rig_lock.take_lock({})
    assert cli.run(["rig", "unlock"]) == 0
    assert f"kill {holder.pid}" in capsys.readouterr().out
    holder.kill()
    holder.wait()
    rig_lock.take_lock({})
    rig_lock.take_lock({})  # the same process may


def test_a_free_rig(holder: subprocess.Popen[str], capsys: pytest.CaptureFixture[str]) -> None:
    holder.kill()
    holder.wait()
    assert cli.run(["rig", "unlock"]) == 0
    out = capsys.readouterr().out
    assert "the test rig: free" in out
    assert "no rig is in use" in out


def test_no_driver_is_one_message(compose: Any, device: VirtualDevice) -> None:
    config = compose("rig=example_pcie", "rig.check_required=false")
    with pytest.raises(RigUnavailable, match="driver is not installed on this computer") as caught:
        backends.run_test(config, 1)
    assert caught.value.exit_code == 1
    assert "rig=virtual" in str(caught.value)


def test_nothing_moves_before_the_check(compose: Any, device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    config = copy.deepcopy(compose("rig.check_required=true"))
    with pytest.raises(RigUnavailable, match="run `hjcamp rig check rig=virtual` first"):
        backends.run_test(config, 1)
    assert device.samples == 0
    assert cli.run(["rig", "check", "rig=virtual", "--yes", "--json", "-"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["passed"] and said["rig"] == "virtual" and all(one["passed"] for one in said["findings"])
    backends.run_test(config, 1)
    config["rig"]["inputs"]["arm"]["sign"] = -1  # another wiring is not checked
    with pytest.raises(RigUnavailable):
        backends.run_test(config, 1)


@pytest.mark.parametrize(
    ("fault", "words", "code"),
    [
        ("reversed_encoder", "the wrong way", 1),
        ("swapped_pressures", "may be exchanged", 1),
        ("noisy_sensor", "look at wiring", 1),
        ("stuck_encoder", "stuck, or not wired", 1),
        ("stuck_pump_encoder", "the encoder does not follow", 1),
        ("lost_sensor", "sensor 1 is lost", 3),
        ("device_gone@900", "COULD NOT BE WRITTEN", 3),
    ],
)
def test_the_check_finds(fault: str, words: str, code: int, device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    device.faults = [parse_fault(fault)]
    assert cli.run(["rig", "check", "rig=virtual", "--yes", "--json", "-"]) == code
    out, err = capsys.readouterr()
    if code == 1:
        answer = json.loads(out)
        assert not answer["passed"] and sum(not one["passed"] for one in answer["findings"]) == 1
    assert words in out + err
    assert device.volts["Dev1/ao1"] == 0.0  # the preload stands still
    device.faults = []


def test_the_user_must_see_the_arm_move(device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    from hjcamp.configuration.composer import Composer
    from hjcamp.plants.pump_joint.rig.check import check_rig

    config = Composer().compose(["backend=nidaqmx"]).config
    findings: list[Any] = []
    assert not check_rig(config, lambda question: False, findings.append)
    assert [one.name for one in findings][-2:] == ["release", "seen"]
    assert "did not see" in findings[-1].text and all(one.passed for one in findings[:-1])


def test_sockets_give_the_same_test(compose: Any, device: VirtualDevice) -> None:
    server, port, remote = start_server()
    try:
        address = f"rig.connection={{kind:address,address:'localhost:{port}'}}"
        lines = (address, "trajectory.amplitude_deg=6", "trajectory.duration=0.05", "trajectory.rise_time=0.05")
        config = compose(*lines)
        config["rig"]["return_speed_mm_per_s"] = None
        measured, _ = backends.run_test(config, 3)
        simulated, _ = backends.run_test({**config, "backend": {"name": "simulation"}}, 3)
        assert (measured["command_deg"] == simulated["command_deg"]).all()
        remote.owner = "somebody else"
        remote.called()
        with pytest.raises(RigUnavailable, match="another client is at work"):
            backends.run_test(config, 3)
    finally:
        server.stop(0).wait()


def test_nobody_answers(compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    import grpc

    class Silent:
        def result(self, timeout: float) -> None:
            raise grpc.FutureTimeoutError

    monkeypatch.setattr(grpc, "channel_ready_future", lambda channel: Silent())
    config = compose("rig.connection={kind:address,address:'localhost:9'}")
    with pytest.raises(RigUnavailable, match="nothing answers at localhost:9"):
        backends.run_test(config, 1)


def test_a_terminal_in_use(compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    arrange = device.arrange

    def with_a_leftover(*arguments: Any) -> None:
        arrange(*arguments)
        device.tasks.create("other")
        device.tasks.add_channel("other", "ai", "Dev1/ai0")

    monkeypatch.setattr(device, "arrange", with_a_leftover)
    with pytest.raises(RigUnavailable, match="another program uses it"):
        backends.run_test(compose(), 1)


def test_faults_are_parsed() -> None:
    assert parse_fault("stuck_encoder@500#2") == Fault("stuck_encoder", 500, 2)
    with pytest.raises(UsageError, match="did you mean 'stuck_encoder'"):
        parse_fault("stuck_encodr")
    with pytest.raises(UsageError, match="whole numbers"):
        parse_fault("stuck_encoder@x")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["payload=none"], "only effects can be hidden"),
        (["effects.leekage.conductance=1"], "leakage"),
        (["--fault", "burst"], "unknown fault 'burst'"),
        (["--address", "here"], "HOST:PORT"),
    ],
)
def test_serve_refuses(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["rig", "serve", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_addresses() -> None:
    check_address("localhost:31763")
    with pytest.raises(UsageError, match="--anybody"):
        check_address("0.0.0.0:31763")
    with pytest.raises(UsageError, match="HOST:PORT"):
        check_address("31763")
