"""Recordings of ROS 2 in SQLite (.db3)."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.cdr import EXTRA, PACKAGES, known_definition, parser_of
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.messages import columns_of, read_messages
from hjcamp.records.elsewhere.reader import Column, Reader, Table, damage_as_refusal
from hjcamp.records.mcap.samples import MOST_MESSAGE_BYTES, MOST_SAMPLES


class Ros2Database(Reader):
    endings = (".db3",)
    says = "a recording of ROS 2"
    extra = EXTRA
    packages = PACKAGES

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named values of the messages on the map's ``topic``."""
        return read_messages(_Database(source, self.says), rules)

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the numbers in the messages of all topics."""
        return columns_of(_Database(source, self.says), rules.topic)


class _Database:
    """The messages of a database, which is opened for reading alone."""

    def __init__(self, source: Path, says: str) -> None:
        self.where, self._source, self._says = str(source), source, says
        topics = self._rows("SELECT name, type, serialization_format FROM topics")
        self._kinds = {str(name): (str(kind), str(form)) for name, kind, form in topics}
        tables = {name for (name,) in self._rows("SELECT name FROM sqlite_master WHERE type = 'table'")}
        there = "message_definitions" in tables
        found = self._rows("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions") if there else []
        self._definitions = {str(kind): str(text) for kind, encoding, text in found if encoding == "ros2msg" and text}

    def topics(self) -> list[str]:
        """Return the topics."""
        return list(self._kinds)

    def messages(self, topic: str) -> Iterator[tuple[int, bytes]]:
        """Yield log time (ns) and content of each message on a topic."""
        asked = "SELECT m.timestamp, m.data FROM messages m JOIN topics t ON m.topic_id = t.id WHERE t.name = ? ORDER BY m.timestamp"
        for number, (time, data) in enumerate(self._rows(asked, topic)):
            if number >= MOST_SAMPLES:
                raise UsageError(f"{self.where}: more than {MOST_SAMPLES} messages on {topic} are no test")
            if not isinstance(data, bytes) or not isinstance(time, int):
                raise UsageError(f"{self.where}: message {number} on {topic} is none of ROS 2")
            if len(data) > MOST_MESSAGE_BYTES:
                raise UsageError(f"{self.where}: message {number} on {topic} is too large for a sample")
            yield min(max(time, 0), np.iinfo(np.int64).max), data

    def parser(self, topic: str) -> Callable[[bytes, int], Any]:
        """Return what makes a message of its content and its number."""
        kind, form = self._kinds[topic]
        if form != "cdr":
            raise UsageError(f"{self.where}: the messages on {topic} are in '{form}'; cdr can be read")
        definition = self._definitions.get(kind) or known_definition(kind, topic, self.where)
        return parser_of(kind, definition, topic, self.where)

    def _rows(self, asked: str, *values: str) -> Iterator[tuple[Any, ...]]:
        address = f"{self._source.resolve().as_uri()}?mode=ro&immutable=1"
        with damage_as_refusal(self._source, self._says), closing(sqlite3.connect(address, uri=True)) as database:
            yield from database.execute(asked, values)
