"""The page of a run in hand: what browsers see, what is dropped, and that nothing of it can hold up a run."""

from __future__ import annotations

import io
import json
import os
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from rich.console import Console

import hjcamp
from hjcamp.backends.recording import Recording, Samples
from hjcamp.campaign.execution.ended_tests import Ends, condition_line, followed_error
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.cli import run
from hjcamp.commands.shared.live import take_live
from hjcamp.errors import UsageError
from hjcamp.live.feed import ROOM, Feed, current_feed
from hjcamp.live.history import MOST_ROWS, History
from hjcamp.live.process import LiveAsk, live_page
from hjcamp.plants.pump_joint.rig.journal import SCALES, Journal
from hjcamp.records.write import LogWriter

VALVES = {"plant": {"name": "valve_joint"}, "backend": {"name": "simulation"}}
LIMIT = {"name": "arm_deg", "unit": "deg", "terms": [{"column": "arm_deg", "factor": 1.0, "late": 0}], "low": -10.0,
         "high": 10.0, "phases": [None, None]}  # fmt: skip


def part(start: int, first: int, values: Any) -> Samples:
    """Return samples of an arm."""
    values = np.asarray(values, dtype=np.float64)
    return Samples({"time_s": np.arange(len(values)) * 1e-3, "arm_deg": values}, start, first, 2)


@contextmanager
def events(address: str) -> Iterator[Iterator[dict[str, Any]]]:
    """Give what a browser is told."""
    with urllib.request.urlopen(f"{address}events", timeout=30) as answer:
        yield (json.loads(line[6:]) for line in answer if line.startswith(b"data: "))


def test_browsers_see_the_test_in_hand_and_the_end() -> None:
    said: list[str] = []
    with live_page(LiveAsk(0, browser=False), said.append):
        assert not said  # no page before there is a run
        feed = current_feed()
        assert feed is not None and feed is current_feed()
        address = said[0].split()[-1]
        assert address.startswith("http://127.0.0.1:")
        feed.run("valves", Path("runs/x"), {"up": VALVES}, {"up": 2}, {"up": 1})
        with events(address) as closed:
            next(closed)  # this browser is closed here
        look = feed.look("up/rep_02", "up")
        look(part(0, -1, np.zeros(50)))
        look(part(50, 20, np.full(50, 350.0)))
        with events(address) as late:
            seen, rows = {}, []
            while seen.get("rows", {}).get("samples") != 100:
                news = next(late)
                seen[news["kind"]] = news
                rows += news.get("rows", [])
            assert (seen["run"]["done"], seen["run"]["total"]) == (1, 2)
            assert seen["test"]["id"] == "up/rep_02"
            assert seen["rows"]["first"] == 20
            arm = 1 + [one["name"] for one in seen["test"]["channels"]].index("arm_deg")
            assert [row[arm] for row in rows] == [0.0] * 10 + [350.0] * 10
            limit = seen["rows"]["limits"][0]
            assert (limit["name"], limit["highest"], round(limit["margin"], 6)) == ("arm_deg", 350.0, 10.0)
            page = urllib.request.urlopen(address, timeout=30).read().decode()
            assert "default-src 'none'" in page and "connect-src 'self'" in page and "src=" not in page.partition("<script")[0]
            asked = urllib.request.Request(address, headers={"Host": "somewhere.example"})
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(asked, timeout=30)
            feed.ended("up/rep_02", "up", None, None, "the arm went too far")
            feed.say("stopped", "made safe")
            feed.close()
            last = [news for news in late if news["kind"] == "run"][-1]
    assert (last["ended"], last["state"], last["failed"]) == (True, "stopped", 1)
    assert last["conditions"]["up"] == {"label": "up", "done": 1, "failed": 1, "total": 2}
    assert current_feed() is None


def test_a_page_that_does_not_read_holds_up_nothing() -> None:
    reading, writing = os.pipe()
    feed = Feed(os.fdopen(writing, "wb", buffering=0))
    feed.run("valves", Path("runs/x"), {"up": VALVES}, {"up": 1}, {})
    look = feed.look("up/rep_01", "up")
    spent = []
    for k in range(3 * ROOM):
        start = time.thread_time()
        look(part(50 * k, -1, np.zeros(50)))
        spent.append(time.thread_time() - start)
    assert feed.dropped >= ROOM
    assert np.median(spent) < 1e-3
    os.close(reading)
    feed.close()
    assert not feed._thread.is_alive()
    feed.ended("up/rep_01", "up", None, None, "")


def test_a_port_that_is_taken_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert run(["run", "trajectory=ramp_pos", "--live", str(port)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"hjcamp: --live {port}: address already in use") and told.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_what_is_asked_of_the_page() -> None:
    for port in (0, -1, 70000, "8123"):
        with pytest.raises(UsageError, match="a port from 1 to 65535 is needed"):
            hjcamp.run("trajectory=ramp_pos", live=port)  # type: ignore[arg-type]
    assert take_live(["a=b"]) == (["a=b"], None)
    assert take_live(["--live", "a=b", "--no-browser"]) == (["a=b"], LiveAsk(0, browser=False))
    assert take_live(["-m", "--live", "8123", "a=b"]) == (["-m", "a=b"], LiveAsk(8123))
    assert take_live(["--live=8123"]) == ([], LiveAsk(8123))
    assert run(["resume", "nowhere", "--port", "8123"]) == 2
    said: list[str] = []
    with live_page(LiveAsk(), said.append):
        pass
    assert "no page was opened" in said[0]
    for words in (["--live", "70000"], ["--live=x"], ["--live", "eighty"], ["--no-browser"]):
        with pytest.raises(UsageError):
            take_live(words)


def test_means_gaps_and_long_tests() -> None:
    history = History(["arm_deg"], 1e-3, [LIMIT])
    history.add({"arm_deg": np.arange(12.0)}, 0, -1)
    assert history.rows == [[2.0, 2.0], [7.0, 7.0]]
    history.add({"arm_deg": np.full(5, 9.0)}, 17, 10)
    assert history.rows[2:] == [[12, None], [19.0, 9.0]]
    assert history.limits_shown()[0]["margin"] == -1.0
    history = History(["arm_deg"], 1e-3, [])
    for k in range(50):
        history.add({"arm_deg": np.full(500, 4.0)}, 500 * k, 0)
    assert len(history.rows) <= MOST_ROWS and history.serial == 1 and history.stretch == 10
    assert np.diff([row[0] for row in history.rows if row[0] is not None]) == pytest.approx(10.0)


def test_who_looks_on_cannot_stop_a_test(tmp_path: Path) -> None:
    shown: list[Samples] = []

    def look(samples: Samples) -> None:
        shown.append(samples)
        raise RuntimeError("the page is gone")

    def writer(path: Path, names: Any) -> LogWriter:
        return LogWriter(path, names, {"campaign": "c"}, {}, replace=True)

    journal = Journal(Recording(tmp_path / "rep_01.mcap", writer, {}, look), 1000)
    for k in range(250):
        journal.rows[k if k < 100 else k + 1, :] = float(k)
        journal.first = 100 if k >= 100 else -1
        journal.add(1 if k == 100 else 0)
    journal.close()
    assert journal.problem is None
    assert sum(len(one.columns["time_s"]) for one in shown) == 251
    assert [one.start for one in shown[1:]] == list(np.cumsum([len(one.columns["time_s"]) for one in shown])[:-1])
    assert (shown[-1].first, shown[-1].missed) == (100, 1)
    assert set(shown[0].columns) == {"time_s", *SCALES}


def test_one_line_for_a_condition() -> None:
    ended = [Outcome(f"a__b/rep_0{k}", "a__b", "done", 1.5, error=("arm_deg", 0.5 + 0.1 * k)) for k in range(3)]
    ended.append(Outcome("a__b/rep_03", "a__b", "failed", 0.5, "lost"))
    assert condition_line("a__b", ended) == "a / b   4 tests, 1 failed, RMS error of arm angle 0.6 ± 0.1 deg, 5.0 s"
    # in a file, as in a CI job, a line is there when the condition has ended, whole and without control codes
    file, tests = io.StringIO(), [SimpleNamespace(id=one.test, condition="a__b", log="x") for one in ended]
    plan = SimpleNamespace(tests=tests, conditions=[], repetitions=4)
    ends = Ends(
        cast(Any, SimpleNamespace(plan=plan, path=Path(), note=print)),
        cast(Any, tests),
        Console(file=file, soft_wrap=True),
    )
    for outcome in ended:
        assert file.getvalue() == ""
        ends(outcome)
    assert file.getvalue() == f"  {condition_line('a__b', ended)}   0 to go\n"
    columns = {"time_s": np.array([-1.0, 0.0, 1.0]), "command_deg": np.zeros(3), "reference_deg": np.full(3, 3.0)}
    assert followed_error({**columns, "arm_deg": np.array([9.0, 0.0, 6.0])}, {}) == ("arm_deg", 3.0)
    assert followed_error({"time_s": np.zeros(2), "arm_deg": np.zeros(2)}, {}) is None
