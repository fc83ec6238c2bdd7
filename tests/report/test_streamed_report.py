"""The report of a run reads one log after the other, once, and says what it would say with all of them in memory."""

from __future__ import annotations

import weakref
from pathlib import Path

import numpy as np
import pytest
from report_samples import as_planned, make_log, make_logs, make_plan, write_plan

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.figures.panels import SIGNALS
from hjcamp.records import stored
from hjcamp.records.find import read_logs
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.stored import StoredLog, kept, stored_logs
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report
from hjcamp.report.runs.spread import gather, with_error

NAMES = ["cycloid_pos__pid", "ramp_pos__pid", "cycloid_pos__ffwd_pid", "ramp_pos__ffwd_pid"]


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run folder of four conditions, three repetitions each."""
    plan = make_plan(NAMES, repetitions=3, tables=["table_5_4_1"])
    for log in (as_planned(one, plan) for one in make_logs(3)):
        path = tmp_path / "run" / "logs" / log.metadata["condition"] / f"rep_{int(log.metadata['repetition']):02d}.mcap"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_log(path, log)
    write_plan(tmp_path / "run", plan)
    return tmp_path / "run"


class Reader:
    """Reads logs and counts how many columns are still there when the next log is read."""

    def __init__(self) -> None:
        self.read: list[Path] = []
        self.most_alive = 0
        self._columns: list[weakref.ref[np.ndarray]] = []

    def __call__(self, path: Path) -> TestLog:
        log = read_log(path)
        self.read.append(path)
        self.most_alive = max(self.most_alive, sum(one() is not None for one in self._columns))
        self._columns.append(weakref.ref(log.columns["arm_deg"]))
        return log


@pytest.fixture
def reader(monkeypatch: pytest.MonkeyPatch) -> Reader:
    counting = Reader()
    monkeypatch.setattr(stored, "read_log", counting)
    return counting


def files(folder: Path) -> dict[str, bytes]:
    there = [folder / "report.html", *(folder / "tables").iterdir()]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in there}


def test_each_log_is_read_once_and_let_go(run: Path, reader: Reader) -> None:
    assert build_report(run, against="published").indicators.height == 12
    assert len(reader.read) == len(set(reader.read)) == 12
    # the three repetitions of a condition are held against each other, no more
    assert reader.most_alive == 2


def test_the_report_is_that_of_logs_in_memory(run: Path, tmp_path: Path) -> None:
    build_report(run, against="published")
    build_report(run, against="published", logs=read_logs([run]), output=tmp_path / "other")
    assert files(run) == files(tmp_path / "other")
    assert len(files(run)) == 7


def test_a_stored_log_is_the_log(run: Path) -> None:
    for there, whole in zip(stored_logs([run]), read_logs([run]), strict=True):
        assert isinstance(there, StoredLog)
        assert (there.metadata, there.attachments, there.path) == (whole.metadata, whole.attachments, whole.path)
        assert (there.samples, there.duration, there.condition_key) == (
            whole.samples,
            whole.duration,
            whole.condition_key,
        )
        for columns, expected in ((there.columns, whole.columns), (there.command_phase, whole.command_phase)):
            assert list(columns) == list(expected)
            assert all(np.array_equal(columns[name], expected[name]) for name in expected)


def test_work_that_asks_often_reads_once_as_long_as_there_is_room(run: Path, reader: Reader) -> None:
    logs = stored_logs([run])
    size = sum(values.nbytes for values in logs[0].columns.values())
    reader.read.clear()
    with kept(logs, room=5 * size):
        for _ in range(3):
            assert all(log.samples for log in logs)
    again = [path for path in reader.read if reader.read.count(path) > 1]
    assert 0 < len(again) < len(reader.read)
    reader.read.clear()
    with kept(logs):
        for _ in range(3):
            assert all(log.samples for log in logs)
    assert len(reader.read) == 12
    assert logs[0].samples and len(reader.read) == 13  # nothing is kept any more


def test_damaged_samples_are_told_and_nothing_is_written(run: Path) -> None:
    path = run / "logs" / NAMES[0] / "rep_02.mcap"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(UsageError, match=r"rep_02\.mcap: .*hjcamp log recover"):
        build_report(run)
    path.write_bytes(content[:600])
    with pytest.raises(UsageError, match=r"rep_02\.mcap: .*truncated.*hjcamp log recover"):
        build_report(run)
    assert not (run / "report.html").exists() and not (run / "tables").exists()


def test_a_log_that_is_replaced_meanwhile_is_refused(run: Path) -> None:
    first, other = stored_logs([run])[:2]
    assert first.path is not None and other.path is not None
    first.path.write_bytes(other.path.read_bytes())
    with pytest.raises(UsageError, match="replaced while it was read"):
        first.columns  # noqa: B018


def test_repetitions_added_one_by_one_are_those_taken_together() -> None:
    random = np.random.default_rng(3)
    logs = [make_log("cycloid_pos", repetition=number) for number in range(1, 6)]
    for log in logs:
        log.columns["arm_deg"] += random.normal(size=log.samples)
    phases = [with_error(log.command_phase) for log in logs]
    found = gather("a", logs, most_points=250)
    for name in SIGNALS:
        if name not in phases[0]:
            assert name not in found.signals
            continue
        values = np.stack([phase[name].reshape(250, 8) for phase in phases])
        spread = found.signals[name]
        assert spread.mean == pytest.approx(values.mean(axis=(0, 2)), abs=1e-12)
        assert np.array_equal(spread.lowest, values.min(axis=(0, 2)))
        assert np.array_equal(spread.highest, values.max(axis=(0, 2)))
