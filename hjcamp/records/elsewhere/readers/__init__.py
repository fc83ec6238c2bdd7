"""The readers of other programs' files: one file each, found here; anything else is a table of text."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from hjcamp.model.files.catalogue import scan
from hjcamp.records.elsewhere.reader import Reader, need

TEXT = "text"


@cache
def readers() -> dict[str, Reader]:
    """Return every reader by its name."""
    return {name: kind() for name, kind in scan(Path(__file__).parent, __name__, Reader).items()}


def reader_of(source: Path) -> Reader:
    """Return the reader of a file by the end of its name; raises UsageError where an extra that it needs is not installed."""
    ending = source.suffix.casefold()
    found = next((one for one in readers().values() if ending in one.endings), readers()[TEXT])
    need(found.extra, found.packages, f"{source}: {found.says}")
    return found


def endings() -> list[str]:
    """Return the ends of names of all files that can be read."""
    return sorted(ending for one in readers().values() for ending in one.endings)
