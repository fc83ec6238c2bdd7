"""Signals: at a safe point, or at once and without an exception in the middle of a call."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hjcamp.backends.rig import stop as rig_stop
from hjcamp.backends.rig.stop import StopSignals, while_moving

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="os.kill")


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """Hear SIGHUP even where the tests were started to outlive their terminal (nohup)."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


def send(number: int) -> None:
    os.kill(os.getpid(), number)


def test_the_first_ctrl_c_waits_for_the_test_the_second_does_not() -> None:
    said: list[str] = []
    with StopSignals(said.append) as signals, while_moving() as moving:
        assert moving is signals
        send(signal.SIGINT)
        assert (signals.asked, signals.reason, len(said)) == (True, None, 1)
        send(signal.SIGINT)
        assert signals.reason == "Ctrl-C"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_the_others_are_immediate_while_something_moves(number: int) -> None:
    with StopSignals(lambda text: None) as signals:
        with while_moving():
            send(number)
        assert signals.reason == f"{signal.Signals(number).name} was received"
        assert not signals.asked


def test_between_tests_the_second_one_raises() -> None:
    with StopSignals(lambda text: None) as signals:
        with while_moving():
            pass
        send(signal.SIGTERM)
        assert signals.asked and signals.reason is None
        with pytest.raises(KeyboardInterrupt):
            send(signal.SIGINT)


def test_without_a_run_the_first_ctrl_c_is_immediate() -> None:
    before = signal.getsignal(signal.SIGINT)
    with while_moving() as signals:
        send(signal.SIGINT)
        assert signals.reason == "Ctrl-C"
    assert signal.getsignal(signal.SIGINT) is before


def test_a_closed_terminal_does_not_matter_under_nohup() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with while_moving() as signals:
            send(signal.SIGHUP)
            assert signals.reason is None
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_terminal_that_is_gone_does_not_break_the_handler() -> None:
    def gone(text: str) -> None:
        raise OSError(5, "Input/output error")

    with StopSignals(gone) as signals:
        send(signal.SIGHUP)
        assert signals.asked


STUCK = """
import ctypes, sys, threading
from hjcamp.backends.rig import stop as rig_stop
rig_stop.PATIENCE_S = 0.5
locked = threading.Lock()
mutex, library = ctypes.create_string_buffer(256), ctypes.CDLL(None)
with rig_stop.StopSignals(print) as signals, rig_stop.while_moving():
    signals.last_words = lambda: "The outputs are safe"
    print("stuck", flush=True)
    for _ in range(2):
        locked.acquire() if sys.argv[1] == "python" else library.pthread_mutex_lock(mutex)
"""


@pytest.mark.parametrize("place", ["python", "driver"])
@pytest.mark.parametrize("numbers", [[signal.SIGTERM], [signal.SIGINT, signal.SIGINT]], ids=["sigterm", "ctrl_c"])
def test_a_stuck_call_does_not_hold_the_process(place: str, numbers: list[int]) -> None:
    environment = {**os.environ, "PYTHONPATH": str(Path(rig_stop.__file__).parents[3])}
    with subprocess.Popen(
        [sys.executable, "-c", STUCK, place], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == "stuck\n"
            for number in numbers[:-1]:
                process.send_signal(number)
                # The first Ctrl-C lets the test in hand finish.
                time.sleep(1.0)
                assert process.poll() is None
            process.send_signal(numbers[-1])
            _, err = process.communicate(timeout=30.0)
            assert process.returncode == 3
            assert "the test has not ended within 0.5 s: a call is stuck. The outputs are safe" in err
        finally:
            process.kill()


def test_a_test_that_ends_in_time_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[str] = []
    monkeypatch.setattr(rig_stop, "PATIENCE_S", 0.05)
    monkeypatch.setattr(StopSignals, "_end", lambda self, reason: ended.append(reason))
    with StopSignals(lambda text: None) as signals:
        with while_moving():
            send(signal.SIGTERM)
        time.sleep(0.2)
        assert signals.reason is not None and ended == []
        with while_moving():
            send(signal.SIGTERM)
            time.sleep(0.2)
        assert ended == ["SIGTERM was received"]
