"""Time limits for code of the user's: in Python it is interrupted, in a compiled kernel the process has to end."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from hjcamp.errors import UsageError

TRIES = 3
TICK_S = 0.2


class _TimeIsUp(BaseException):
    """Raised inside code that does not end."""


@contextmanager
def time_limit(seconds: float, what: str) -> Iterator[None]:
    """Raise ``UsageError`` with ``what`` where the Python code inside takes longer (s, wall clock).

    Code that cannot be interrupted, or catches what interrupts it, ends the process with that message.
    """
    thread, over, guard = threading.get_ident(), threading.Event(), threading.Lock()
    told = f"{what} did not end within {seconds:g} s: is there a loop that never ends?"
    asked = 0

    def watch() -> None:
        nonlocal asked
        if over.wait(seconds):
            return
        for _ in range(TRIES):
            with guard:
                if over.is_set():
                    return
                asked += 1
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(_TimeIsUp))
            if over.wait(1.0):
                return
        _end_process(told)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        try:
            yield
        finally:
            while not over.is_set():
                with contextlib.suppress(_TimeIsUp), guard:
                    over.set()
            if asked:
                # What was asked for may still be on its way: it must not come out somewhere else.
                with contextlib.suppress(_TimeIsUp):
                    time.sleep(0.05)
    except _TimeIsUp:
        asked = max(asked, 1)
    if asked:
        raise UsageError(told)


class RunLimit:
    """A limit for one call of a compiled kernel (s of this process's computing; compiling does not count)."""

    def __init__(self, seconds: float, what: str, end: Callable[[str], None] | None = None) -> None:
        self._seconds, self._end = seconds, end or _end_process
        self._told = f"{what} did not end within {seconds:g} s of computing: is there a loop that never ends?"

    @contextmanager
    def __call__(self) -> Iterator[None]:
        """Watch what is done inside."""
        over = threading.Event()
        watcher = threading.Thread(target=self._watch, args=(over,), daemon=True)
        watcher.start()
        try:
            yield
        finally:
            over.set()
            watcher.join()

    def _watch(self, over: threading.Event) -> None:
        from numba.core.compiler_lock import global_compiler_lock

        spent, before = 0.0, time.process_time()
        while not over.wait(TICK_S):
            now = time.process_time()
            # numba holds this lock while it compiles.
            if global_compiler_lock._lock.acquire(blocking=False):
                global_compiler_lock._lock.release()
                spent += now - before
            before = now
            if spent > self._seconds:
                self._end(self._told)
                return


def _end_process(told: str) -> None:
    """End a process that nothing else can stop: a kernel does not look at signals."""
    with contextlib.suppress(OSError, ValueError):
        print(f"hjcamp: {told}", file=sys.stderr, flush=True)
    os._exit(UsageError.exit_code)
