"""What the run tells its page: every call returns at once and never fails, whatever became of the page."""

from __future__ import annotations

import contextlib
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextvars import ContextVar
from pathlib import Path
from typing import IO, Any

import numpy as np

from hjcamp.backends.recording import Look, Samples
from hjcamp.live.messages import block_of, packed
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.report.wording.names import readable

#: Messages that wait for the page at most; about ten seconds of a rig. The oldest is dropped for the newest.
ROOM = 256
GONE_S = 1.0


class Feed:
    """A bounded buffer in front of a pipe, and the thread that empties it. ``dropped`` counts what did not fit."""

    def __init__(self, stream: IO[bytes]) -> None:
        self.dropped = 0
        self._stream = stream
        self._waiting: deque[tuple[dict[str, Any], bytes]] = deque(maxlen=ROOM)
        self._wake = threading.Event()
        self._closed = False
        self._compiling = ""
        self._described: dict[str, dict[str, Any]] = {}
        self._counts: dict[str, dict[str, Any]] = {}
        self._configs: Mapping[str, Mapping[str, Any]] = {}
        self._run: dict[str, Any] = {}
        self._thread = threading.Thread(target=self._send, name="live page", daemon=True)
        self._thread.start()

    def run(self, name: str, folder: Path, configs: Mapping[str, Mapping[str, Any]], tests: Mapping[str, int],
            kept: Mapping[str, int]) -> None:  # fmt: skip
        """Say what is run: the ``configs`` of its conditions, how many ``tests`` each has, how many were ``kept``."""
        self._configs = configs
        self._described = {}
        self._counts = {
            one: {"label": readable(one), "done": kept.get(one, 0), "failed": 0, "total": tests[one]} for one in tests
        }
        self._run = {"done": sum(kept.values()), "failed": 0, "total": sum(tests.values())}
        backend = str(next(iter(configs.values()), {}).get("backend", {}).get("name", ""))
        about = {
            "name": name,
            "folder": str(folder),
            "backend": backend,
            "began": time.time(),
            "state": "running",
            "words": "",
        }
        self._put({"kind": "run", "run": {**about, **self._run, "conditions": self._counts, "here": sum(kept.values())}})

    def look(self, test: str, condition: str) -> Look:
        """Return what is shown the samples of a test while it is made."""
        # here, before the loop begins: the first description imports what it needs
        told = self._test(test, condition)
        begun = False

        def look(samples: Samples) -> None:
            nonlocal begun
            if not begun:
                begun = True
                self._compiled()
                self._put({"kind": "test", "test": told})
            missed = np.full(len(samples.columns["time_s"]), float(samples.missed))
            columns = {**samples.columns, "missed_samples": missed}
            head = {"kind": "samples", "test": test, "columns": list(columns), "start": samples.start, "first": samples.first}
            self._put(head, block_of(columns))

        return look

    def ended(self, test: str, condition: str, log: Path | None, error: tuple[str, float] | None, message: str) -> None:
        """Say how a test ended: its ``log`` where it is whole, the RMS ``error`` of what was controlled, what went wrong."""
        counts = self._counts.setdefault(condition, {"done": 0, "failed": 0, "total": 0})
        kind = "failed" if log is None else "done"
        counts[kind] += 1
        self._run[kind] += 1
        self._compiled()
        if error is not None:
            counts["error"] = [error[1], unit_of_field(error[0], test).shown]
        told = {
            "kind": "outcome",
            "condition": condition,
            "counts": dict(counts),
            "run": {**self._run, "message": message},
        }
        self._put({**told, "test": self._test(test, condition), "log": None if log is None else str(log.absolute())})

    def compiling(self, words: str) -> None:
        """Say what is compiled before the first test; empty words: nothing."""
        self._compiling = words
        self.say("running", words)

    def say(self, state: str, words: str) -> None:
        """Say how the run ended; another one of the same sweep may follow."""
        self._put({"kind": "run", "run": {"state": state, "words": words}})

    def close(self) -> None:
        """Give the page a moment for what waits, and let go of it."""
        self._closed = True
        self._wake.set()
        self._thread.join(GONE_S)

    def _test(self, test: str, condition: str) -> dict[str, Any]:
        if condition not in self._described:
            from hjcamp.live.describe import describe, nothing_known

            # a plant that cannot be described is the run's to complain of, not the page's
            try:
                self._described[condition] = describe(self._configs[condition])
            except Exception:
                self._described[condition] = nothing_known()
        label = f"{readable(condition)}, {test.partition('/')[2].replace('rep_', 'repetition ')}".removesuffix(", ")
        return {"id": test, "label": label, "condition": condition, **self._described[condition]}

    def _compiled(self) -> None:
        if self._compiling:
            self.compiling("")

    def _put(self, head: dict[str, Any], block: bytes = b"") -> None:
        self.dropped += len(self._waiting) == ROOM
        self._waiting.append((head, block))
        self._wake.set()

    def _send(self) -> None:
        # a page that is gone is no business of the run's
        with contextlib.suppress(OSError, ValueError), self._stream:
            while not self._closed or self._waiting:
                self._wake.wait()
                self._wake.clear()
                while self._waiting:
                    left = memoryview(packed(*self._waiting.popleft()))
                    while left:
                        left = left[self._stream.write(left) :]


_current: ContextVar[Callable[[], Feed] | None] = ContextVar("live page", default=None)


def current_feed() -> Feed | None:
    """Return the page of the call in hand, opened by the first who asks; None where nobody wants one."""
    opened = _current.get()
    return None if opened is None else opened()


@contextlib.contextmanager
def feeding(feed: Callable[[], Feed]) -> Iterator[None]:
    """While open, runs tell what they do to what ``feed`` returns."""
    token = _current.set(feed)
    try:
        yield
    finally:
        _current.reset(token)
