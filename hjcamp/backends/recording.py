"""Where a test in hand is written while it runs; the caller says it, a backend that needs it asks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
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
class Samples:
    """Samples that were just put into a log: number ``start`` and those after it; ``first`` begins the command phase, -1 before.

    ``missed`` is how many of all samples so far the loop did not see.
    """

    columns: Mapping[str, np.ndarray]
    start: int
    first: int
    missed: int


Look = Callable[[Samples], None]


@dataclass(frozen=True)
class Recording:
    """The final name of a log, and what opens a writer for a log of some name with some fields.

    ``notes`` is what the backend knows of itself before the test begins (devices, host); it goes into every writer.
    ``look`` is shown what goes into the log, by the thread that writes it, never by a control loop.
    """

    path: Path
    open_writer: Callable[[Path, Sequence[str]], Writer]
    notes: dict[str, str] = field(default_factory=dict)
    look: Look | None = None


_current: ContextVar[Recording | None] = ContextVar("recording", default=None)


@contextmanager
def recording(
    path: Path,
    open_writer: Callable[[Path, Sequence[str]], Writer],
    notes: dict[str, str] | None = None,
    look: Look | None = None,
) -> Iterator[None]:
    """While open, a test is written to ``path`` + ``.part`` as it runs; that file goes when the context ends well.

    The backend adds to ``notes``; ``open_writer`` is called after that.
    """
    token = _current.set(Recording(path, open_writer, {} if notes is None else notes, look))
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
