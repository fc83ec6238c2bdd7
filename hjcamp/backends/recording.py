"""Where a test in hand is written while it runs; the caller says it, a backend that needs it asks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np


class Writer(Protocol):
    """What writes samples to a file ``NAME.part``; ``hjcamp.records.write.LogWriter`` does."""

    part: Path

    def append_many(self, columns: Mapping[str, np.ndarray]) -> None:
        """Add samples and put them on the disk."""

    def abort(self) -> Path:
        """Stop and leave what was written as ``NAME.part``."""


@dataclass(frozen=True)
class Recording:
    """The final name of a log, and what opens a writer for a log of some name with some fields."""

    path: Path
    open_writer: Callable[[Path, Sequence[str]], Writer]


_current: ContextVar[Recording | None] = ContextVar("recording", default=None)


@contextmanager
def recording(path: Path, open_writer: Callable[[Path, Sequence[str]], Writer]) -> Iterator[None]:
    """While open, a test is written to ``path`` + ``.part`` as it runs; that file goes when the context ends well."""
    token = _current.set(Recording(path, open_writer))
    try:
        yield
        part_of(path).unlink(missing_ok=True)
    finally:
        _current.reset(token)


def current_recording() -> Recording | None:
    """Return where the test in hand is to be written, None where nobody asked for it."""
    return _current.get()


def part_of(path: Path) -> Path:
    """Return the name of an unfinished log."""
    return path.with_name(path.name + ".part")
