"""Test logs that stay in their files: what they say of themselves is read, their columns only while they are used."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from hjcamp.errors import UsageError
from hjcamp.records.find import find_logs, of_the_plan, tell
from hjcamp.records.log import TestLog
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.scan import Scan, load, metadata_of, take, walk
from hjcamp.records.read import attachments_of, read_log

ROOM_BYTES = 128 * 2**20


class Shelf:
    """Reads logs when their columns are asked for, and keeps the last one, so that memory does not grow with their number.

    As long as there is ``room`` (bytes) others are kept as well. Texts that many logs share are kept once.
    """

    def __init__(self) -> None:
        self.room = 0
        self._last: TestLog | None = None
        self._kept: dict[Path, TestLog] = {}
        self._texts: dict[str | bytes, str | bytes] = {}

    def head(self, path: Path) -> StoredLog:
        """Return a log without reading its samples; raises ``UsageError`` as ``read_log`` does for a file that is no log."""
        data = load(path)
        found = Scan()
        try:
            for opcode, start, end in walk(data, len(MCAP0_MAGIC), len(data) - len(MCAP0_MAGIC), found):
                if opcode == Opcode.DATA_END:
                    break
                if opcode in (Opcode.METADATA, Opcode.ATTACHMENT):
                    take(found, opcode, data[start:end], start)
        except Damaged:
            read_log(path)  # says what is wrong, and what to do
            raise
        once = self._texts.setdefault
        metadata = {str(once(key, key)): str(once(value, value)) for key, value in metadata_of(found).items()}
        attachments = {str(once(name, name)): bytes(once(data, data)) for name, data in attachments_of(found).items()}  # type: ignore[arg-type]
        return StoredLog(self, path, metadata, attachments)

    def read(self, log: StoredLog) -> TestLog:
        """Return a log with its columns."""
        if log.path in self._kept:
            return self._kept[log.path]
        if self._last is None or self._last.path != log.path:
            self._last = None  # two of them are never there at once
            self._last = read_log(log.path)
            if self._last.metadata != log.metadata:
                raise UsageError(f"{log.path}: was replaced while it was read; try again")
            if (size := sum(values.nbytes for values in self._last.columns.values())) <= self.room:
                self._kept[log.path] = self._last
                self.room -= size
        return self._last

    def clear(self) -> None:
        """Let every log go."""
        self.room, self._last = 0, None
        self._kept.clear()


class StoredLog(TestLog):
    """A test log whose columns are read from its file when they are asked for."""

    path: Path
    shelf: Shelf

    def __init__(self, shelf: Shelf, path: Path, metadata: dict[str, str], attachments: dict[str, bytes]) -> None:
        for name, value in (("shelf", shelf), ("path", path), ("metadata", metadata), ("attachments", attachments)):
            object.__setattr__(self, name, value)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """The columns, read now unless this is the log that was read last."""
        return self.shelf.read(self).columns

    @property
    def command_phase(self) -> dict[str, np.ndarray]:
        """The columns in phase 3 (command and control) alone; all rows where the log has no ``phase``."""
        return self.shelf.read(self).command_phase


def stored_logs(paths: Sequence[str | Path], say: Callable[[str], None] = tell) -> list[TestLog]:
    """Return the logs that ``read_logs`` would return, in the same order, with columns that are read when they are used.

    A file that cannot be read raises where its columns are asked for, or here where it is no log at all.
    """
    shelf = Shelf()
    return of_the_plan([shelf.head(path) for path in find_logs(paths)], paths, say)


@contextmanager
def kept(logs: Sequence[TestLog], room: int = ROOM_BYTES) -> Iterator[None]:
    """Keep the columns of stored logs that are read in here, for work that asks for them often, up to ``room`` bytes."""
    shelves = {id(log.shelf): log.shelf for log in logs if isinstance(log, StoredLog)}
    for shelf in shelves.values():
        shelf.room = room
    try:
        yield
    finally:
        for shelf in shelves.values():
            shelf.clear()
