"""Running: the same logs on any number of workers, going on, failures, a full disk, stopping."""

from __future__ import annotations

import io
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

import hjcamp.backends
from hjcamp.campaign.conclude import grouped
from hjcamp.campaign.execution import workers as worker_processes
from hjcamp.campaign.execution.one_test import Job
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.campaign.execution.stop_rule import StopRule
from hjcamp.campaign.files.run_folder import RunFolder, folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import RunResult, run_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError, Interrupted, RigStopped, UsageError
from hjcamp.records.plan import Plan
from hjcamp.records.read import read_log

pytestmark = pytest.mark.usefixtures("quick_backend", "empty_folder")
LINES = ["trajectory=ramp_pos", "repetitions=3"]


@pytest.fixture(scope="module")
def plan(composer: Composer) -> Plan:
    return make_plan(composer.compose(["campaign=controllers", *LINES]).config, "controllers", LINES, composer)


def start(plan: Plan, name: str) -> RunFolder:
    return folder_for(plan, {}, [], Path(name))[0]


def run(folder: RunFolder, **options: Any) -> RunResult:
    return run_plan(folder, Console(file=io.StringIO()), **{"workers": 1, **options})


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*.mcap"))}


def replace_backend(monkeypatch: pytest.MonkeyPatch, run_test: Callable[..., Any]) -> None:
    monkeypatch.setattr(hjcamp.backends, "run_test", run_test)


def test_every_log_says_what_it_is(plan: Plan) -> None:
    folder = start(plan, "one")
    assert run(folder).done == 6
    log = read_log(folder.path / "logs/ramp_pos__ffwd_pid/rep_02.mcap")
    expected = {"campaign": "controllers", "condition": "ramp_pos__ffwd_pid", "trajectory": "ramp_pos"}
    expected |= {"controller": "ffwd_pid", "payload": "none", "orientation": "horizontal", "pump": "pump2"}
    expected |= {"amplifier": "high_gain", "tubing": "ldpe_300mm", "backend": "simulation", "repetition": "2"}
    assert expected.items() <= log.metadata.items()
    test = next(test for test in plan.tests if test.id == "ramp_pos__ffwd_pid/rep_02")
    assert log.metadata["seed"] == str(test.seed)
    assert b"name: ffwd_pid" in log.attachments["config.yaml"]
    manifest = open_folder(folder.path).manifest
    assert manifest["state"] == "complete"
    assert {entry["state"] for entry in manifest["tests"].values()} == {"done"}
    assert manifest["sessions"][0]["ended_at"]


def test_two_workers_write_the_same_logs(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    import numpy as np

    def in_worker(job: Job) -> Outcome:
        # A worker is a fresh process: the quick backend has to be put there too. Sent by value, as a closure.
        import hjcamp.backends
        from hjcamp.campaign.execution.one_test import execute_in_worker

        def quick(config: dict[str, Any], seed: int) -> tuple[dict[str, Any], dict[str, str]]:
            noise = np.random.default_rng(seed).normal(size=50)
            columns = {"time_s": np.arange(50) * 1e-3, "arm_deg": noise, "pump_deg": noise}
            return columns | {"pressure1_mpa": noise, "pressure2_mpa": noise}, {"process": "any"}

        hjcamp.backends.run_test = quick  # type: ignore[attr-defined, unused-ignore]
        outcome = execute_in_worker(job)
        assert os.getpid() != runner
        return outcome

    runner = os.getpid()
    monkeypatch.setattr(worker_processes, "execute_in_worker", in_worker)
    two = start(plan, "two")
    assert run(two, workers=2).done == 6
    runner = -1
    monkeypatch.setattr(worker_processes, "execute", in_worker)
    one = start(plan, "one")
    assert run(one, workers=1).done == 6
    assert contents(one.path) == contents(two.path)
    assert len(contents(one.path)) == 6


def test_a_run_goes_on_where_it_stopped(plan: Plan) -> None:
    whole = start(plan, "whole")
    run(whole)
    folder = start(plan, "half")
    run(folder)
    lost, damaged = (folder.path / test.log for test in plan.tests[:2])
    lost.unlink()
    half = lost.with_name(f"{lost.name}.4711.part")
    half.write_bytes(b"what a killed worker left")
    damaged.write_bytes(damaged.read_bytes()[:-300])
    kept = folder.path / plan.tests[2].log
    untouched = kept.stat().st_mtime_ns
    said: list[str] = []
    result = run(open_folder(folder.path), announce=said.append)
    assert (result.done, result.kept) == (2, 4)
    assert kept.stat().st_mtime_ns == untouched
    assert contents(folder.path) == contents(whole.path)
    assert not half.exists()
    assert damaged.with_suffix(".mcap.damaged").exists()
    assert "is damaged" in said[0]


def test_a_run_keeps_a_log_of_what_was_said_and_when(plan: Plan) -> None:
    folder = start(plan, "logged")
    run(folder)
    run(folder)
    lines = (folder.path / "run.log").read_text().splitlines()
    assert all(re.match(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\S*  ", line) for line in lines)
    said = [line.partition("  ")[2] for line in lines]
    assert said[0].startswith("session 1: ") and " to make, " in said[0]
    number = len(folder.plan.tests)
    assert sum(line.startswith("complete: ") for line in said) == 2 and said[-1] == f"complete: {number} of {number} tests done"
    assert len([line for line in said if "RMS error" in line]) == len(folder.plan.conditions)
    assert any(line.startswith("session 2: 0 tests to make") for line in said)


def test_a_failure_is_noted_and_the_run_goes_on(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    good = hjcamp.backends.run_test  # type: ignore[attr-defined, unused-ignore]

    def fails_once(config: dict[str, Any], seed: int) -> Any:
        if seed == plan.tests[1].seed:
            raise HjcampError("the joint broke")
        if seed == plan.tests[4].seed:
            raise ZeroDivisionError("oops")
        return good(config, seed)

    replace_backend(monkeypatch, fails_once)
    folder = start(plan, "some")
    result = run(folder)
    assert result.done == 4
    assert result.failures[0] == (plan.tests[1].id, "the joint broke")
    entries = open_folder(folder.path).manifest
    assert entries["state"] == "failed"
    assert "internal error: ZeroDivisionError" in entries["tests"][plan.tests[4].id]["message"]
    assert "Traceback" in entries["tests"][plan.tests[4].id]["detail"]
    replace_backend(monkeypatch, good)
    assert run(open_folder(folder.path)).done == 2


def test_fail_fast_stops_at_the_first_failure(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(config: dict[str, Any], seed: int) -> Any:
        raise UsageError("no")

    replace_backend(monkeypatch, fails)
    assert len(run(start(plan, "fast"), rule=StopRule(fail_fast=True)).failures) == 1


def test_a_full_disk_ends_the_run_with_nothing_half_written(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    real = os.replace

    def full(source: Any, target: Any) -> None:
        if str(target).endswith("rep_02.mcap"):
            raise OSError(28, "No space left on device")
        real(source, target)

    monkeypatch.setattr(os, "replace", full)
    folder = start(plan, "full")
    with pytest.raises(HjcampError, match="No space left on device") as caught:
        run(folder)
    assert caught.value.exit_code == 1
    assert "hjcamp resume full" in str(caught.value)
    assert list(contents(folder.path)) == [plan.tests[0].log]
    assert not list(folder.path.rglob("*.mcap.*"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_one_signal_finishes_the_test_in_hand(plan: Plan, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    good = hjcamp.backends.run_test  # type: ignore[attr-defined, unused-ignore]

    def interrupted(config: dict[str, Any], seed: int) -> Any:
        if seed == plan.tests[2].seed:
            os.kill(os.getpid(), number)
        return good(config, seed)

    replace_backend(monkeypatch, interrupted)
    before = signal.getsignal(number)
    folder = start(plan, "stopped")
    with pytest.raises(Interrupted, match="3 of 6 tests left; go on with: hjcamp resume stopped"):
        run(folder)
    assert signal.getsignal(number) is before
    assert len(contents(folder.path)) == 3
    assert open_folder(folder.path).manifest["state"] == "interrupted"


def test_a_second_signal_stops_now(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    good = hjcamp.backends.run_test  # type: ignore[attr-defined, unused-ignore]

    def interrupted(config: dict[str, Any], seed: int) -> Any:
        if seed == plan.tests[2].seed:
            os.kill(os.getpid(), signal.SIGINT)
            os.kill(os.getpid(), signal.SIGINT)
        return good(config, seed)

    replace_backend(monkeypatch, interrupted)
    folder = start(plan, "now")
    with pytest.raises(Interrupted):
        run(folder)
    assert len(contents(folder.path)) == 2


def test_a_rig_that_was_made_safe_ends_the_run(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    def unsafe(config: dict[str, Any], seed: int) -> Any:
        raise RigStopped("pressure above its limit")

    replace_backend(monkeypatch, unsafe)
    with pytest.raises(RigStopped, match="pressure above its limit"):
        run(start(plan, "safe"))


def test_a_rig_has_one_process() -> None:
    assert worker_processes.available_workers(8, "nidaqmx") == (1, True)
    assert worker_processes.available_workers(3, "simulation") == (3, True)
    assert worker_processes.available_workers(None, "simulation")[1] is False


def test_warnings_that_differ_in_numbers_are_one() -> None:
    warnings = {"a line ran down to -0.10 MPa": 2, "a line ran down to -0.09 MPa": 3, "late": 1}
    assert grouped(warnings) == [("for example: a line ran down to -0.09 MPa", 5), ("late", 1)]
