"""Little memory: libraries that cannot bear it are not loaded where a limit of the system leaves less than they take."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from typing import Any

# Address space in MB that a library takes when it is loaded and used, measured (polars 2 threads: 1000) and rounded up. With less,
# polars ends the process without a word to Python, and the linear algebra of scipy waits for memory for ever.
NEEDED_MB = {"polars": 1200, "scipy": 200, "numba": 250, "matplotlib": 100}
LIBRARY_MB = 512


def room_mb() -> float:
    """Return how much address space a limit of the system (``ulimit -v``) leaves this process, MB; infinite without one."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit == resource.RLIM_INFINITY:
            return float("inf")
        with open("/proc/self/statm", encoding="ascii") as stream:
            used = int(stream.read().split()[0]) * resource.getpagesize()
    except (ImportError, OSError, ValueError):
        return float("inf")
    return (limit - used) / 2**20


def memory_is_short() -> bool:
    """Return whether a limit of the system leaves less than a library takes: its import fails in odd ways then."""
    return room_mb() < LIBRARY_MB


class _Guard(MetaPathFinder):
    """Refuses a library before it is loaded; finds no module itself."""

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: Any = None) -> None:
        needed, room = NEEDED_MB.get(fullname, 0), room_mb()
        if room < needed:
            raise MemoryError(f"a limit of the system (ulimit -v) leaves {room:.0f} MB, and {fullname} takes {needed}")


def guard_memory() -> None:
    """Raise ``MemoryError`` from now on where a library is imported for which a limit of the system leaves no room."""
    if room_mb() < float("inf") and not any(isinstance(one, _Guard) for one in sys.meta_path):
        sys.meta_path.insert(0, _Guard())
