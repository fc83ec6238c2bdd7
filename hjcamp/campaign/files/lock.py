"""One process at a time in a run folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hjcamp import locks
from hjcamp.errors import UsageError

NAME = ".lock"


@contextmanager
def run_lock(folder: Path) -> Iterator[None]:
    """Hold the lock of a run folder; raises ``UsageError`` where another process holds it."""
    descriptor = locks.take(folder / NAME, str(os.getpid()))
    if descriptor is None:
        holder = ""
        with suppress(OSError):
            holder = (folder / NAME).read_text(errors="replace")[:64].strip()
        raise UsageError(f"another run is at work in {folder}" + (f" (process {holder})" if holder else ""))
    try:
        yield
    finally:
        locks.release(descriptor)


def is_locked(folder: Path) -> bool:
    """Return whether a process is at work in the folder."""
    try:
        return locks.is_held(folder / NAME)
    except OSError:
        return False
