"""Signals of a run, the one place that hears them: stop after the test in hand, or make the rig safe now."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any

NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
_current: list[StopSignals] = []


class StopSignals:
    """While open, ``asked`` says to stop at the next safe point, ``reason`` why the rig must be made safe now.

    ``announce`` is told of the first one; without it nobody waits for the end of a test, so the first Ctrl-C is
    immediate. While the rig moves (``moving``) nothing is raised, not even in the middle of a call: a second Ctrl-C,
    SIGTERM and a closed terminal set ``reason``. While it does not, the second signal raises ``KeyboardInterrupt``.
    """

    def __init__(self, announce: Callable[[str], None] | None = None) -> None:
        self.asked = False
        self.reason: str | None = None
        self._announce = announce
        self._moving = False
        self._before: dict[int, Any] = {}

    @contextmanager
    def moving(self) -> Iterator[StopSignals]:
        """While open, something on the rig may move."""
        self._moving = True
        try:
            yield self
        finally:
            self._moving = False

    def __enter__(self) -> StopSignals:
        _current.append(self)
        if threading.current_thread() is threading.main_thread():
            for number in [getattr(signal, name) for name in NAMES if hasattr(signal, name)]:
                # `nohup` means that a closed terminal does not matter.
                if signal.Signals(number).name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._hear)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        _current.remove(self)

    def _hear(self, number: int, frame: FrameType | None) -> None:
        first = not self.asked and self._announce is not None
        if self._moving and not (first and number == signal.SIGINT):
            self.reason = "Ctrl-C" if number == signal.SIGINT else f"{signal.Signals(number).name} was received"
            return
        if not first:
            raise KeyboardInterrupt
        self.asked = True
        # The terminal may be what was closed.
        with suppress(OSError):
            assert self._announce is not None
            self._announce("stopping after the tests in hand; once more to stop now")


@contextmanager
def while_moving() -> Iterator[StopSignals]:
    """Give the signals of the run in hand, or fresh ones where there is none, for as long as the rig may move."""
    if _current:
        with _current[-1].moving() as signals:
            yield signals
        return
    with StopSignals() as signals, signals.moving():
        yield signals
