"""One process at a time in a run folder; the lock ends with the process, however it ends."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hjcamp.errors import UsageError

NAME = ".lock"
# Who only looks takes a shared lock for an instant: a run waits that long for it.
PATIENCE_S = 0.25


@contextmanager
def run_lock(folder: Path) -> Iterator[None]:
    """Hold the lock of a run folder; raises ``UsageError`` where another process holds it."""
    descriptor = os.open(folder / NAME, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        last = time.monotonic() + PATIENCE_S
        while not (taken := _take(descriptor)) and time.monotonic() < last:
            time.sleep(0.01)
        if not taken:
            holder = os.pread(descriptor, 64, 0).decode(errors="replace").strip() if hasattr(os, "pread") else ""
            raise UsageError(f"another run is at work in {folder}" + (f" (process {holder})" if holder else ""))
        os.ftruncate(descriptor, 0)
        os.write(descriptor, str(os.getpid()).encode())
        yield
    finally:
        os.close(descriptor)


def is_locked(folder: Path) -> bool:
    """Return whether a process is at work in the folder."""
    try:
        descriptor = os.open(folder / NAME, os.O_RDWR)
    except OSError:
        return False
    try:
        return not _take(descriptor, look=True)
    finally:
        os.close(descriptor)


def _take(descriptor: int, look: bool = False) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, (fcntl.LOCK_SH if look else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
