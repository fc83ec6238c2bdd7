"""MCAP files of other programs: JSON, protobuf, and ROS 2 (cdr)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel
from mcap.writer import MCAP0_MAGIC

from hjcamp.errors import UsageError
from hjcamp.json_text import json_values
from hjcamp.records.elsewhere.cdr import parser_of
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.messages import columns_of, read_messages
from hjcamp.records.elsewhere.reader import Column, Reader, Table
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.layout import MESSAGE_PREFIX
from hjcamp.records.mcap.protobuf_samples import message_type
from hjcamp.records.mcap.salvage import salvage
from hjcamp.records.mcap.samples import MOST_MESSAGE_BYTES, MOST_SAMPLES
from hjcamp.records.mcap.scan import load, scan, take, walk


class Mcap(Reader):
    endings = (".mcap",)
    says = "MCAP"

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named values of the messages on the map's ``topic``; of a file that is cut off, of the whole ones."""
        recording = McapRecording(source)
        found = read_messages(recording, rules)
        return Table(found.columns, found.times, (*recording.notes, *found.notes))

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the numbers in the messages of all topics."""
        return columns_of(McapRecording(source), rules.topic)


class McapRecording:
    """The messages of an MCAP file, read once; ``notes`` say what was lost of it."""

    def __init__(self, source: Path) -> None:
        self.where = str(source)
        self.notes: tuple[str, ...] = ()
        data = load(source)
        try:
            self.found = scan(data)
        except Damaged as fault:
            if data.endswith(MCAP0_MAGIC):
                raise UsageError(f"{source}: {fault}") from fault
            self.found = salvage(data).found
            self.notes = (f"{fault}: the whole messages are read, what came after them is lost",)
        self._described = False

    def topics(self) -> list[str]:
        """Return the topics, also of channels that the file describes in a chunk."""
        if not self._described:
            for stretch in self.found.stretches:
                for opcode, content, end in walk(stretch, 0, len(stretch), self.found):
                    if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                        take(self.found, opcode, stretch[content:end], content)
            self._described = True
        return [channel.topic for channel in self.found.channels.values()]

    def messages(self, topic: str) -> Iterator[tuple[int, bytes]]:
        """Yield log time (ns) and content of each message on the topic."""
        channel, number = self._channel(topic), 0
        for stretch in self.found.stretches:
            for opcode, content, end in walk(stretch, 0, len(stretch)):
                if opcode != Opcode.MESSAGE or end - content < MESSAGE_PREFIX:
                    continue
                if int.from_bytes(stretch[content : content + 2], "little") != channel.id:
                    continue
                if end - content > MOST_MESSAGE_BYTES:
                    raise UsageError(f"{self.where}: message {number} on {topic} is too large for a sample")
                number += 1
                if number > MOST_SAMPLES:
                    raise UsageError(f"{self.where}: more than {MOST_SAMPLES} messages on {topic} are no test")
                time = int.from_bytes(stretch[content + 6 : content + 14], "little")
                yield min(time, np.iinfo(np.int64).max), stretch[content + MESSAGE_PREFIX : end]

    def parser(self, topic: str) -> Callable[[bytes, int], Any]:
        """Return what makes a message of its content and its number."""
        channel, where = self._channel(topic), self.where
        schema = self.found.schemas.get(channel.schema_id)
        if channel.message_encoding == "json":
            return lambda data, index: _parse_json(data, index, where)
        if channel.message_encoding == "protobuf":
            if schema is None or schema.encoding != "protobuf":
                raise UsageError(f"{where}: protobuf messages need a protobuf schema; {topic} has none")
            kind = message_type(schema, where)[0]
            return lambda data, index: _parse_protobuf(kind, data, index, where)
        if channel.message_encoding == "cdr":
            if schema is None or schema.encoding != "ros2msg":
                said = f"'{schema.encoding}'" if schema else "none"
                raise UsageError(f"{where}: the messages on {topic} are in cdr; their schema is to be in ros2msg, it is {said}")
            return parser_of(schema.name, schema.data.decode("utf-8", "replace"), topic, where)
        raise UsageError(
            f"{where}: the messages on {topic} are in '{channel.message_encoding}'; json, protobuf and cdr can be read"
        )

    def _channel(self, topic: str) -> Channel:
        return next(channel for channel in self.found.channels.values() if channel.topic == topic)


def _parse_json(data: bytes, index: int, where: str) -> Any:
    try:
        content = json_values(data)
    except ValueError as error:
        raise UsageError(f"{where}: message {index} is not JSON") from error
    if not isinstance(content, dict):
        raise UsageError(f"{where}: message {index} is no JSON object")
    return content


def _parse_protobuf(kind: Any, data: bytes, index: int, where: str) -> Any:
    from google.protobuf.message import DecodeError

    try:
        return kind.FromString(data)
    except DecodeError as error:
        raise UsageError(f"{where}: message {index} is no {kind.DESCRIPTOR.full_name}") from error
