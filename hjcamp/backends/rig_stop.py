"""Signals during a test: noted, never raised in the middle of a call; the loop makes the rig safe."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")


class StopSignals:
    """While open, ``reason`` says why to stop now, or is None.

    The first Ctrl-C goes to who waited for it before (the run then ends after this test); only where that raises, as
    it does on the second one, the stop is immediate. SIGTERM and a closed terminal are always immediate.
    """

    def __init__(self) -> None:
        self.reason: str | None = None
        self._before: dict[int, Any] = {}

    def __enter__(self) -> StopSignals:
        if threading.current_thread() is threading.main_thread():
            for name in NAMES:
                number = getattr(signal, name, None)
                if number is not None:
                    self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if number != signal.SIGINT:
            self.reason = f"{signal.Signals(number).name} was received"
            return
        before = self._before.get(number)
        if not callable(before):
            self.reason = "Ctrl-C"
            return
        try:
            before(number, frame)
        except KeyboardInterrupt:
            self.reason = "Ctrl-C"
