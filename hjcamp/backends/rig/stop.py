"""Signals of a run, the one place that hears them: stop after the test in hand, or make the rig safe now."""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any

NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
PATIENCE_S = 5.0  # from a stop that was asked for to the end of the test, whatever call is stuck
LAST_WORDS_S = 1.0
EXIT_CODE = 3
_current: list[StopSignals] = []


class StopSignals:
    """While open, ``asked`` says to stop at the next safe point, ``reason`` why the rig must be made safe now.

    ``announce`` is told of the first one; without it nobody waits for the end of a test, so the first Ctrl-C is
    immediate. While the rig moves (``moving``) nothing is raised, not even in the middle of a call: a second Ctrl-C,
    SIGTERM and a closed terminal set ``reason``. While it does not, the second signal raises ``KeyboardInterrupt``.
    Where the test has not ended ``PATIENCE_S`` after ``reason``, a call is stuck: ``last_words`` is called, and the
    process ends.
    """

    def __init__(self, announce: Callable[[str], None] | None = None) -> None:
        self.asked = False
        self.reason: str | None = None
        self.last_words: Callable[[], str] | None = None
        self._announce = announce
        self._moving = False
        self._still = threading.Event()
        self._before: dict[int, Any] = {}

    @contextmanager
    def moving(self) -> Iterator[StopSignals]:
        """While open, something on the rig may move."""
        self._moving = True
        self._still.clear()
        try:
            with self._watched():
                yield self
        finally:
            self._moving = False
            self._still.set()
            self.last_words = None

    def __enter__(self) -> StopSignals:
        _current.append(self)
        if threading.current_thread() is threading.main_thread():
            for number in [getattr(signal, name) for name in NAMES if hasattr(signal, name)]:
                # `nohup` means that a closed terminal does not matter.
                if signal.Signals(number).name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._hear)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        _current.remove(self)

    def _hear(self, number: int, frame: FrameType | None) -> None:
        first = not self.asked and self._announce is not None
        if self._moving and not (first and number == signal.SIGINT):
            self.reason = _reason(number)
            return
        if not first:
            raise KeyboardInterrupt
        self.asked = True
        # The terminal may be what was closed.
        with suppress(OSError):
            assert self._announce is not None
            self._announce("stopping after the tests in hand; once more to stop now")

    @contextmanager
    def _watched(self) -> Iterator[None]:
        # A handler runs between two lines of Python; a call that is stuck in the driver never comes to the next one.
        if not self._before or threading.current_thread() is not threading.main_thread():
            yield
            return
        told, heard = socket.socketpair()
        told.setblocking(False)
        before = signal.set_wakeup_fd(told.fileno(), warn_on_full_buffer=False)
        threading.Thread(target=self._listen, args=(heard,), name="stop signals", daemon=True).start()
        try:
            yield
        finally:
            signal.set_wakeup_fd(before)
            told.close()  # which ends the thread

    def _listen(self, heard: socket.socket) -> None:
        waits = self._announce is not None and not self.asked
        with heard:
            while number := heard.recv(1):
                if number[0] not in self._before:
                    continue
                if waits and number[0] == signal.SIGINT:
                    waits = False
                    continue
                self.reason = self.reason or _reason(number[0])
                if not self._still.wait(PATIENCE_S):
                    self._end(self.reason)

    def _end(self, reason: str) -> None:
        words = [f"{reason}, and the test has not ended within {PATIENCE_S:g} s: a call is stuck"]

        def ask() -> None:
            words.append("Nothing had been moved yet" if self.last_words is None else self.last_words())

        asking = threading.Thread(target=ask, daemon=True)
        asking.start()
        asking.join(LAST_WORDS_S)
        with suppress(OSError, ValueError):
            os.write(sys.stderr.fileno(), f"\nhjcamp: {'. '.join(words)}\n".encode())
        os._exit(EXIT_CODE)


def _reason(number: int) -> str:
    return "Ctrl-C" if number == signal.SIGINT else f"{signal.Signals(number).name} was received"


@contextmanager
def while_moving() -> Iterator[StopSignals]:
    """Give the signals of the run in hand, or fresh ones where there is none, for as long as the rig may move."""
    if _current:
        with _current[-1].moving() as signals:
            yield signals
        return
    with StopSignals() as signals, signals.moving():
        yield signals
