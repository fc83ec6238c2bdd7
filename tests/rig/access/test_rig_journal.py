"""The log of a test in hand: on the disk while it runs, with the right times, and nothing is overwritten."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from hjcamp.backends.recording import Recording, part_of, recording
from hjcamp.backends.rig.timing import LoopTiming, undisturbed
from hjcamp.plants.pump_joint.rig.journal import SCALES, Journal, keep_stopped
from hjcamp.records.recover import recover_log
from hjcamp.records.write import LogWriter

KILLED = """
import sys, time
from pathlib import Path
from hjcamp.backends.recording import Recording
from hjcamp.plants.pump_joint.rig.journal import Journal
from hjcamp.records.write import LogWriter
open_writer = lambda p, n: LogWriter(p, n, {"campaign": "c"}, {}, replace=True)
journal = Journal(Recording(Path(sys.argv[1]), open_writer), 100000)
start = time.perf_counter()
for k in range(100000):
    while time.perf_counter() - start < k * 1e-3:
        time.sleep(2e-4)
    journal.rows[k] = k
    journal.rows[k, 0] = 3.0
    if k == 100:
        journal.first = 100
    journal.add(0)
    if k % 50 == 0:
        print(k, flush=True)
"""


def writer(path: Path, names: Sequence[str]) -> LogWriter:
    return LogWriter(path, names, {"campaign": "c"}, {"config.yaml": b"a: 1"}, replace=True)


def fill(journal: Journal, samples: int, first: int) -> None:
    for k in range(samples):
        journal.rows[k, :] = float(k)
        journal.rows[k, 0] = 3.0 if first <= k else 0.0
        if k == first:
            journal.first = k
        journal.add(0)


def test_times_are_right_from_the_start(tmp_path: Path) -> None:
    path = tmp_path / "logs" / "rep_01.mcap"
    journal = Journal(Recording(path, writer), 1000)
    fill(journal, 400, 300)
    journal.close()
    assert sorted(p.name for p in path.parent.iterdir()) == ["rep_01.mcap.part"]
    recovered = recover_log(part_of(path), tmp_path / "whole.mcap")
    assert recovered.kept == 400
    from hjcamp.records.read import read_log

    log = read_log(recovered.path)
    assert log.columns["time_s"][300] == 0.0
    assert log.columns["time_s"][0] == pytest.approx(-0.3)
    assert log.metadata["campaign"] == "c"
    assert log.attachments["config.yaml"] == b"a: 1"
    np.testing.assert_allclose(log.columns["pump_deg"], np.arange(400) * SCALES["pump_deg"])


def test_a_stop_before_the_command_phase_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "rep_01.mcap"
    journal = Journal(Recording(path, writer), 1000)
    fill(journal, 250, 900)
    journal.close()
    assert [p.name for p in tmp_path.iterdir()] == ["rep_01.mcap.part"]


def test_what_was_stopped_is_put_aside(tmp_path: Path) -> None:
    path = tmp_path / "rep_01.mcap"
    for text in ("one", "two"):
        part_of(path).write_text(text)
        keep_stopped(path)
    assert (tmp_path / "rep_01.stopped_1.mcap.part").read_text() == "one"
    assert (tmp_path / "rep_01.stopped_2.mcap.part").read_text() == "two"
    assert not list(tmp_path.glob("*.mcap"))


def test_a_whole_log_needs_no_part(tmp_path: Path) -> None:
    path = tmp_path / "rep_01.mcap"
    with recording(path, writer):
        part_of(path).write_text("x")
    assert not part_of(path).exists()
    with pytest.raises(ValueError, match="stop"), recording(path, writer):
        part_of(path).write_text("x")
        raise ValueError("stop")
    assert part_of(path).exists()


def test_a_disk_that_fails_is_a_problem_not_an_exception(tmp_path: Path) -> None:
    class Full(LogWriter):
        def append_many(self, columns: object) -> None:
            raise OSError(28, "No space left on device")

    journal = Journal(Recording(tmp_path / "rep_01.mcap", lambda p, n: Full(p, n, {}, {}, replace=True)), 1000)
    fill(journal, 200, 100)
    journal.close()
    assert "No space left" in str(journal.problem)


def test_missed_samples_repeat_the_row_before(tmp_path: Path) -> None:
    journal = Journal(None, 10)
    journal.rows[0] = 1.0
    journal.add(0)
    journal.rows[1] = 2.0
    journal.add(2)
    assert journal.count == 4
    assert journal.rows[:4, 0].tolist() == [1.0, 1.0, 1.0, 2.0]


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9")
def test_kill_costs_at_most_200_ms(tmp_path: Path) -> None:
    path = tmp_path / "rep_01.mcap"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(path)], stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    last = 0
    while last < 600:
        last = int(process.stdout.readline())
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    rest = process.stdout.read().split()
    process.stdout.close()
    last = int(rest[-1]) if rest else last
    kept = recover_log(part_of(path), tmp_path / "whole.mcap").kept
    assert kept >= last - 200


def test_histogram() -> None:
    timing = LoopTiming(10, virtual=False)
    for moment in (0, 1_000_000, 2_000_000, 3_400_000, 15_000_000):
        timing.cycle(moment, 0)
    assert timing.histogram() == "0.9-1.1ms:2 1.1-1.5ms:1 10ms-:1"


def test_nothing_is_collected_while_the_loop_runs() -> None:
    before = sys.getswitchinterval()
    with undisturbed():
        assert not gc.isenabled()
        assert sys.getswitchinterval() < 1e-4
    assert gc.isenabled()
    assert sys.getswitchinterval() == before


def test_the_loop_is_not_delayed_by_the_disk(tmp_path: Path) -> None:
    class Slow(LogWriter):
        def append_many(self, columns: object) -> None:
            time.sleep(0.3)

    journal = Journal(Recording(tmp_path / "rep_01.mcap", lambda p, n: Slow(p, n, {}, {}, replace=True)), 5000)
    start = time.perf_counter()
    fill(journal, 3000, 100)
    assert time.perf_counter() - start < 0.25
    journal.close()
