"""Signals: at a safe point, or at once and without an exception in the middle of a call."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator

import pytest

from hjcamp.backends.rig_stop import StopSignals, while_moving

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
