"""Columns of the messages on one topic of an MCAP file that another program wrote, JSON or protobuf."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.json_text import json_values
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.layout import MESSAGE_PREFIX
from hjcamp.records.mcap.protobuf_samples import message_type
from hjcamp.records.mcap.samples import MOST_MESSAGE_BYTES, MOST_SAMPLES
from hjcamp.records.mcap.scan import Scan, load, scan, take, walk

MISSING = object()
Getter = Callable[[Any, str], Any]


def read_messages(source: Path, names: list[str], topic: str, where: str) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return the named values of each message on ``topic``, and the log times, s; a name may lead inwards: ``pose.x``.

    Raises UsageError for a file or message that cannot be read, a topic or name that is not there.
    """
    try:
        whole = scan(load(source))
        channel = _channel(whole, topic, source, where)
        messages = sorted(_messages(whole, channel, source), key=lambda one: one[0])
    except Damaged as fault:
        raise UsageError(f"{source}: {fault}") from fault
    if not messages:
        raise UsageError(f"{source}: there is no message on the topic {topic}")
    parse, get = _decoder(whole, channel, str(source))
    columns = {name: np.empty(len(messages)) for name in names}
    for index, (_, data) in enumerate(messages):
        content = parse(data, index)
        for name, values in columns.items():
            value = get(content, name)
            if value is MISSING and index == 0 and name not in (known := _names(content)):
                raise unknown("name", name, known, f"the messages on {topic} of {source}")
            if value is MISSING:
                raise UsageError(f"{source}: '{name}' is missing in message {index} on {topic}")
            if isinstance(value, bool) or not isinstance(value, int | float):
                found = " ".join(repr(value).split())
                raise UsageError(f"{source}: '{name}' is no number in message {index} on {topic}: {found:.40}")
            try:
                values[index] = value
            except OverflowError as error:
                raise UsageError(f"{source}: '{name}' is too large in message {index} on {topic}") from error
    times = np.array([time for time, _ in messages], dtype=np.int64)
    return columns, (times - times[0]) * 1e-9


def _channel(found: Scan, topic: str, source: Path, where: str) -> Channel:
    """Return the channel of the topic, also where the file describes it in a chunk."""
    for stretch in found.stretches:
        for opcode, content, end in walk(stretch, 0, len(stretch), found):
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                take(found, opcode, stretch[content:end], content)
    topics = [channel.topic for channel in found.channels.values()]
    if not topic:
        listed = ", ".join(dict.fromkeys(topics)) or "none"
        raise UsageError(f"{where}: give the topic of {source}: 'topic: NAME', one of {listed}")
    if topic not in topics:
        raise unknown("topic", topic, topics, str(source))
    if topics.count(topic) > 1:
        raise UsageError(f"{source}: {counted(topics.count(topic), 'channel')} on {topic}; one can be read")
    return next(channel for channel in found.channels.values() if channel.topic == topic)


def _messages(found: Scan, channel: Channel, source: Path) -> Iterator[tuple[int, bytes]]:
    """Yield log time (ns) and content of each message on the channel."""
    number = 0
    for stretch in found.stretches:
        for opcode, content, end in walk(stretch, 0, len(stretch)):
            if opcode != Opcode.MESSAGE or end - content < MESSAGE_PREFIX:
                continue
            if int.from_bytes(stretch[content : content + 2], "little") != channel.id:
                continue
            if end - content > MOST_MESSAGE_BYTES:
                raise UsageError(f"{source}: message {number} on {channel.topic} is too large for a sample")
            number += 1
            if number > MOST_SAMPLES:
                raise UsageError(f"{source}: more than {MOST_SAMPLES} messages on {channel.topic} are no test")
            time = int.from_bytes(stretch[content + 6 : content + 14], "little")
            yield min(time, np.iinfo(np.int64).max), stretch[content + MESSAGE_PREFIX : end]


def _decoder(found: Scan, channel: Channel, where: str) -> tuple[Callable[[bytes, int], Any], Getter]:
    if channel.message_encoding == "json":
        return lambda data, index: _parse_json(data, index, where), _get_json
    if channel.message_encoding == "protobuf":
        schema = found.schemas.get(channel.schema_id)
        if schema is None or schema.encoding != "protobuf":
            raise UsageError(f"{where}: protobuf messages need a protobuf schema; {channel.topic} has none")
        kind = message_type(schema, where)[0]
        return lambda data, index: _parse_protobuf(kind, data, index, where), _get_protobuf
    raise UsageError(
        f"{where}: the messages on {channel.topic} are in '{channel.message_encoding}'; json and protobuf can be read"
    )


def _parse_json(data: bytes, index: int, where: str) -> Any:
    try:
        content = json_values(data)
    except ValueError as error:
        raise UsageError(f"{where}: message {index} is not JSON") from error
    if not isinstance(content, dict):
        raise UsageError(f"{where}: message {index} is no JSON object")
    return content


def _get_json(content: Any, name: str) -> Any:
    if name in content:
        return content[name]
    for part in name.split("."):
        content = content.get(part, MISSING) if isinstance(content, dict) else MISSING
    return content


def _parse_protobuf(kind: Any, data: bytes, index: int, where: str) -> Any:
    from google.protobuf.message import DecodeError

    try:
        return kind.FromString(data)
    except DecodeError as error:
        raise UsageError(f"{where}: message {index} is no {kind.DESCRIPTOR.full_name}") from error


def _get_protobuf(content: Any, name: str) -> Any:
    for part in name.split("."):
        known = getattr(getattr(content, "DESCRIPTOR", None), "fields_by_name", {})
        if part not in known or (known[part].has_presence and not content.HasField(part)):
            return MISSING
        content = getattr(content, part)
    return content


def _names(content: Any) -> list[str]:
    if isinstance(content, dict):
        return [str(name) for name in content]
    return list(content.DESCRIPTOR.fields_by_name)
