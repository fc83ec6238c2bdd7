"""Tests of a run on a dask cluster: really started, a worker or the scheduler killed, and everything that may be missing."""

from __future__ import annotations

import io
import json
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from rich.console import Console

import hjcamp
import hjcamp.cluster
from hjcamp.campaign.execution import on_cluster
from hjcamp.campaign.execution.one_test import Job, make_jobs
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.campaign.files.run_folder import RunFolder, folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import RunResult, run_plan
from hjcamp.cluster import as_done, connected, imported
from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.plan import Plan

LINES = ["trajectory=ramp_pos", "controller=pid", "repetitions=12"]
REPOSITORY = Path(hjcamp.__file__).parent.parent


@pytest.fixture(scope="module")
def plan(composer: Composer) -> Plan:
    return make_plan(composer.compose(LINES).config, None, LINES, composer)


@dataclass
class Cluster:
    """A scheduler and two workers, each a process of its own, and the address."""

    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]]
    address: str


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    paths = os.pathsep.join([str(REPOSITORY), *filter(None, [os.environ.get("PYTHONPATH")])])
    started: list[subprocess.Popen[bytes]] = []

    def start(*words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", *words, "--scheduler-file", str(file), "--no-dashboard"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        (tmp_path / "workers").mkdir(exist_ok=True)
        place = {"cwd": tmp_path / "workers", "env": os.environ | {"PYTHONPATH": paths}}
        started.append(subprocess.Popen(command, **quiet, **place))  # type: ignore[call-overload]
        return started[-1]

    try:
        scheduler = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0")
        workers = [start("distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny") for _ in range(2)]
        end = time.monotonic() + 60.0
        while not (file.exists() and file.read_text().rstrip().endswith("}")):
            assert time.monotonic() < end and scheduler.poll() is None, "the scheduler does not start"
            time.sleep(0.05)
        yield Cluster(scheduler, workers, json.loads(file.read_text())["address"])
    finally:
        for process in started:
            process.kill()
            process.wait()


def folder(plan: Plan, name: str) -> RunFolder:
    return folder_for(plan, {}, [], Path(name))[0]


def run(there: RunFolder, **options: Any) -> RunResult:
    return run_plan(there, Console(file=io.StringIO()), **options)


def logs(there: RunFolder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((there.path / "logs").rglob("*.*"))}


def kill_at_third(monkeypatch: pytest.MonkeyPatch, process: Callable[[], subprocess.Popen[bytes]]) -> None:
    """Kill a process of the cluster when its third log has come."""
    put, seen = on_cluster.put_log, []

    def put_log(job: Job, outcome: Outcome, content: bytes) -> Outcome:
        seen.append(job.test.id)
        if len(seen) == 3:
            process().kill()
        return put(job, outcome, content)

    monkeypatch.setattr(on_cluster, "put_log", put_log)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("empty_folder")
def test_the_logs_are_those_of_a_local_run_though_a_worker_is_killed(
    plan: Plan, cluster: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    there, here = folder(plan, "there"), folder(plan, "here")
    client = connected(cluster.address, "cluster=")
    try:
        client.wait_for_workers(2, timeout=60)
        kill_at_third(monkeypatch, lambda: cluster.workers[0])
        result = run(there, cluster=client)
        assert cluster.workers[0].wait() != 0
        assert len(client.nthreads()) == 1
    finally:
        client.close()
    assert (result.done, result.failures) == (12, [])
    assert open_folder(there.path).manifest["sessions"][0]["workers"] == 2
    run(here, workers=1)
    assert logs(there) == logs(here)
    assert len(logs(here)) == 12


@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("empty_folder")
def test_a_scheduler_that_is_killed_is_one_message_and_the_run_goes_on_without_it(
    plan: Plan, cluster: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = folder(plan, "there")
    client = connected(cluster.address)
    try:
        client.wait_for_workers(1, timeout=60)
        kill_at_third(monkeypatch, lambda: cluster.scheduler)
        with pytest.raises(HjcampError, match="the dask cluster is gone: ") as caught:
            run(there, cluster=client)
        assert "\n" not in str(caught.value)
    finally:
        client.close()
    assert open_folder(there.path).manifest["state"] == "interrupted"
    result = run(open_folder(there.path), workers=1)
    assert result.kept >= 3 and result.kept + result.done == 12


@pytest.mark.study
@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("empty_folder")
def test_the_command_line_takes_a_cluster(cluster: Cluster) -> None:
    paths = os.pathsep.join([str(REPOSITORY), *filter(None, [os.environ.get("PYTHONPATH")])])

    def hjcamp_command(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "hjcamp", *words]
        return subprocess.run(command, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True)

    made = hjcamp_command("run", *LINES[:2], "repetitions=2", "run_dir=run", f"cluster={cluster.address}")
    assert made.returncode == 0, made.stderr
    assert "2 tests, 0 failed" in made.stdout and Path("run/report.html").exists()
    before = Path("run/logs/ramp_pos__pid/rep_02.mcap")
    content = before.read_bytes()
    before.unlink()
    again = hjcamp_command("resume", "run", "--cluster", cluster.address)
    assert again.returncode == 0, again.stderr
    assert before.read_bytes() == content
    wrong = hjcamp_command("run", *LINES[:2], "repetitions=1", "run_dir=wrong", "cluster=nowhere")
    assert (wrong.returncode, wrong.stderr.count("\n")) == (2, 1)
    assert "cluster=nowhere: no dask scheduler answers" in wrong.stderr and not Path("wrong").exists()


class NoCluster:
    """A client whose tasks end as they are told, or never."""

    def __init__(self, threads: int = 1, error: Exception | None = None) -> None:
        self.threads, self.error, self.submitted = threads, error, 0

    def nthreads(self) -> dict[str, int]:
        return {"tcp://one:1": self.threads} if self.threads else {}

    def submit(self, task: Callable[..., Any], item: object, pure: bool) -> Any:
        self.submitted += 1
        future: Future[Any] = Future()
        if self.error is not None:
            future.set_exception(self.error)
        elif self.threads:
            future.set_result(task(item))
        return future

    def cancel(self, futures: object) -> None:
        pass


@pytest.fixture
def no_dask(monkeypatch: pytest.MonkeyPatch) -> None:
    """The errors of dask without dask."""
    for name, content in {"": {}, "client": {"CancelledError": KeyError}, "scheduler": {"KilledWorker": KeyError}}.items():
        module = ModuleType(f"distributed.{name}".rstrip("."))
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, module.__name__, module)


@pytest.mark.usefixtures("no_dask")
def test_no_more_is_handed_out_than_the_cluster_does_soon_and_nothing_after_a_stop() -> None:
    client, seen = NoCluster(threads=3), []
    for item, result in as_done(client, lambda number: number**2, range(100), stop=lambda: len(seen) == 10):
        assert result == item**2
        seen.append(item)
    assert len(seen) == 10
    assert client.submitted <= 10 + 2 * 3
    assert dict(as_done(NoCluster(), abs, [-1, -2])) == {-1: 1, -2: 2}


@pytest.mark.usefixtures("no_dask")
def test_a_cluster_without_workers_is_not_waited_for_forever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hjcamp.cluster, "NO_WORKER_S", 0.2)
    monkeypatch.setattr(hjcamp.cluster, "LOOK_EVERY_S", 0.05)
    with pytest.raises(HjcampError, match="has had no worker for 0 s"):
        list(as_done(NoCluster(threads=0), abs, [1]))


@pytest.mark.usefixtures("no_dask")
@pytest.mark.parametrize(
    "error", [ModuleNotFoundError("No module named 'hjcamp'"), RuntimeError("Error during deserialization of the task")]
)
def test_workers_without_the_program_are_one_message(error: Exception) -> None:
    with pytest.raises(HjcampError, match=r"a worker of the dask cluster cannot run this: .*install hjcamp there"):
        list(as_done(NoCluster(error=error), abs, [1]))
    with pytest.raises(ZeroDivisionError):
        list(as_done(NoCluster(error=ZeroDivisionError()), abs, [1]))


@pytest.fixture
def job(plan: Plan, empty_folder: Path) -> Job:
    return make_jobs(plan, plan.tests[:1], empty_folder / "run")[0]


def test_a_worker_with_another_program_makes_no_log(job: Job) -> None:
    other = replace(job, metadata=job.metadata | {"version": "9.9"})
    outcome, content = on_cluster.execute_for_another(other)
    assert (outcome.state, outcome.stops, content) == ("failed", 1, None)
    assert f"version {hjcamp.__version__}, not 9.9" in outcome.message


def test_a_test_that_fails_there_is_told_with_the_name_here(job: Job, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(config: object, seed: object) -> None:
        raise HjcampError("the arm broke")

    monkeypatch.setattr("hjcamp.backends.run_test", fails)
    outcome, content = on_cluster.execute_for_another(job)
    assert (outcome.state, outcome.message, content) == ("failed", "the arm broke", None)


def test_a_full_disk_here_stops_the_run_and_leaves_nothing(job: Job, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    done = Outcome(job.test.id, job.test.condition, "done", 1.0)
    monkeypatch.setattr("os.fsync", full)
    outcome = on_cluster.put_log(job, done, b"content")
    assert (outcome.state, outcome.stops) == ("failed", 1)
    assert "No space left" in outcome.message
    assert list(job.path.parent.iterdir()) == []
    monkeypatch.undo()
    assert on_cluster.put_log(job, done, b"content") == done
    assert job.path.read_bytes() == b"content"


def test_only_simulated_tests_go_to_a_cluster(composer: Composer) -> None:
    lines = ["trajectory=ramp_pos", "backend=nidaqmx", "repetitions=1"]
    rig = make_plan(composer.compose(lines).config, None, lines, composer)
    with pytest.raises(UsageError, match="not those of nidaqmx"), on_cluster.cluster_for("local", rig, "cluster="):
        pass
    with on_cluster.cluster_for(None, rig, "cluster=") as client:
        assert client is None


def test_without_dask_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"cluster needs dask: pip install 'hjcamp\[cluster\]'"):
        connected("tcp://127.0.0.1:1", "cluster=")


def test_work_beside_the_package_is_imported_where_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "beside_the_package.py").write_text("def twice(number, add):\n    return 2 * number + add\n")
    monkeypatch.setattr(sys, "path", list(sys.path))
    assert imported((str(tmp_path), "beside_the_package", "twice", pickle.dumps((3, 1)))) == 7


@pytest.mark.study
@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("empty_folder")
def test_the_cases_of_a_benchmark_go_to_a_cluster_and_those_of_a_killed_worker_again(
    cluster: Cluster,
) -> None:
    from benchmarks.hidden_effects.cases import plan as cases
    from benchmarks.on_cluster import there

    asked = cases("small", 4, 0)
    came = []
    for case in there("benchmarks.hidden_effects.one_case", "cleaned", [(one,) for one in asked], cluster.address):
        came.append(case)
        if len(came) == 2:
            cluster.workers[0].kill()
    assert sorted(one.name for one in came) == sorted(one.name for one in asked)
