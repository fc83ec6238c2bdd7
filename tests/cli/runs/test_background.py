"""What compiles in the background: one process at a time, where the cache is; killed, it leaves nothing that is in the way."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from hjcamp import locks
from hjcamp.commands.shared import warm
from hjcamp.known_plants import usual_plant

if TYPE_CHECKING:
    from conftest import Call


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder of its own."""
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kernels"


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """Note what would be started instead of starting it."""
    calls: list[list[str]] = []

    class Noted:
        pid = 4321

        def __init__(self, command: list[str], **options: Any) -> None:
            assert options["start_new_session"] and options["stdout"] is subprocess.DEVNULL
            calls.append(command)

    monkeypatch.setattr(warm.subprocess, "Popen", Noted)
    return calls


def test_it_is_started_once(call: Call, cache: Path, started: list[list[str]]) -> None:
    answer = call("doctor", "--warm", "--detach")
    assert answer.code == 0 and "process 4321" in answer.out and "kill 4321" in answer.out
    assert started == [[sys.executable, "-m", "hjcamp.commands.shared.warm"]]
    held = locks.take(cache / warm.LOCK, "77\n")
    assert held is not None
    try:
        assert "process 77 is compiling" in call("doctor", "--warm", "--detach").out and len(started) == 1
    finally:
        locks.release(held)
    assert call("doctor", "--warm", "--detach").code == 0 and len(started) == 2, "a lock ends with its process"


def test_detach_alone_is_refused(call: Call, started: list[list[str]]) -> None:
    answer = call("doctor", "--detach")
    assert answer.code == 2 and "--warm" in answer.err and not started


def test_nothing_is_started_where_nothing_is_kept(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, started: list[list[str]]
) -> None:
    monkeypatch.setattr(warm, "cache_folder", lambda: tmp_path / f"{warm.TEMPORARY}x" / "kernels")
    answer = call("doctor", "--warm", "--detach")
    assert answer.code == 0 and "cannot be written" in answer.out and not started


def test_the_process_compiles_for_a_diagnosis_first_and_waits_for_another(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = usual_plant().own_room("kernels")
    order: list[str] = []
    monkeypatch.setattr(room, "side_by_side", lambda work: ((order.append(name), 0.0) for name, _, _ in work))
    monkeypatch.setattr(room, "tasks", lambda: [("next, a", print, ()), ("diagnose, b", print, ()), ("run c", print, ())])
    monkeypatch.setattr(warm, "LOOK_EVERY_S", 0.01)
    monkeypatch.setattr(warm.os, "nice", lambda more: more)
    held = locks.take(warm.cache_folder() / warm.LOCK, "77\n")
    assert held is not None
    other = threading.Thread(target=warm.main, args=(cache,))
    other.start()
    time.sleep(0.1)
    assert not order, "never two at once"
    locks.release(held)
    other.join(20.0)
    assert order == ["diagnose, b", "next, a", "run c"]
    assert not warm.at_work()


def test_the_tour_waits_for_what_it_needs_alone(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from hjcamp.campaign.execution.console import make_console

    room, looks = usual_plant().own_room("kernels"), iter([["a"], ["a"], []])
    monkeypatch.setattr(room, "missing", lambda effects: next(looks))
    monkeypatch.setattr(warm, "LOOK_EVERY_S", 0.01)
    warm.wait(make_console())
    assert next(looks) == ["a"], "nobody compiles: nothing is looked at"
    held = locks.take(warm.cache_folder() / warm.LOCK, "77\n")
    assert held is not None
    try:
        warm.wait(make_console())
    finally:
        locks.release(held)
    assert next(looks, None) is None
