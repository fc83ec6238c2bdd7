"""Columns of the messages in an MCAP file that another program wrote, JSON or protobuf."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel
from mcap.writer import MCAP0_MAGIC

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.json_text import json_values
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.map_values import GAPS_HINT
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.layout import MESSAGE_PREFIX
from hjcamp.records.mcap.protobuf_samples import message_type
from hjcamp.records.mcap.salvage import salvage
from hjcamp.records.mcap.samples import MOST_MESSAGE_BYTES, MOST_SAMPLES
from hjcamp.records.mcap.scan import Scan, load, scan, take, walk

MISSING = object()
Getter = Callable[[Any, str], Any]
# A value within a message: pose.x, position[0].
STEP = re.compile(r"\.?(?P<name>[^.[]+)|\[(?P<at>\d+)\]")
# The two parts of a stamp, as ROS 1, ROS 2 and protobuf call them.
STAMPS = (("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec"), ("seconds", "nanos"))
NS = 1e-9
CDR = (
    " (convert a recording of ROS 2, in cdr, to a table: read_ros2_messages of the Python package mcap-ros2-support gives its "
    "messages with their times)"
)


def read_messages(source: Path, rules: ImportMap) -> tuple[dict[str, np.ndarray], np.ndarray, tuple[str, ...]]:
    """Return the named values of each message on the topic of ``rules``, the log times, s, and what to say of the file.

    A name may lead inwards (``pose.x``, ``position[0]``), or to a stamp of seconds and nanoseconds. A value on a topic of its own
    is brought to the times of these messages: by a line, or as it was last where its field holds its value. Of a file that
    is cut off, the whole messages are read. Raises UsageError for a file or message that cannot be read, a topic or name
    that is not there.
    """
    found, notes = _whole_or_salvaged(source)
    wanted: dict[str, dict[str, str]] = {rules.topic: {}}
    for rule in rules.rules.values():
        wanted.setdefault(rule.topic or rules.topic, {})[rule.key] = rule.column
    held = {rule.key for name, rule in rules.rules.items() if name in rules.held}
    try:
        read = {topic: _topic(found, topic, names, source, rules) for topic, names in wanted.items()}
    except Damaged as fault:
        raise UsageError(f"{source}: {fault}") from fault
    columns, times = read.pop(rules.topic)
    start = int(times[0])
    at = (times - start) * NS
    for topic, (others, other_times) in read.items():
        if (late := int(np.count_nonzero(times < other_times[0]))) and not rules.interpolate and not others.keys() <= held:
            raise UsageError(f"{source}: {counted(late, 'message')} on {rules.topic} before the first on {topic}; {GAPS_HINT}")
        own = (other_times - start) * NS
        last = np.searchsorted(other_times, times, side="right") - 1
        for key, values in others.items():
            columns[key] = values[np.maximum(last, 0)] if key in held else np.interp(at, own, values)
        if late:
            notes += (f"{counted(late, 'message')} on {rules.topic} before the first on {topic}, whose first value is taken",)
    return columns, at, notes


def _whole_or_salvaged(source: Path) -> tuple[Scan, tuple[str, ...]]:
    data = load(source)
    try:
        return scan(data), ()
    except Damaged as fault:
        if data.endswith(MCAP0_MAGIC):
            raise UsageError(f"{source}: {fault}") from fault
        return salvage(data).found, (f"{fault}: the whole messages are read, what came after them is lost",)


def _topic(
    found: Scan, topic: str, names: dict[str, str], source: Path, rules: ImportMap
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return the named values of the messages on one topic, and their log times, ns."""
    channel = _channel(found, topic, source, rules.where)
    messages = sorted(_messages(found, channel, source), key=lambda one: one[0])
    if not messages:
        raise UsageError(f"{source}: there is no message on the topic {topic}")
    parse, get = _decoder(found, channel, str(source))
    columns = {key: np.empty(len(messages)) for key in names}
    firsts: dict[str, int] = {}
    for index, (_, data) in enumerate(messages):
        content = parse(data, index)
        for key, name in names.items():
            value = get(content, name)
            if value is MISSING and index == 0 and STEP.split(name, maxsplit=1)[1] not in (known := _names(content)):
                raise _unknown_name(name, known, topic, found, source)
            if (ticks := _stamp(value)) is not None:
                value = (ticks - firsts.setdefault(key, ticks)) * NS
            columns[key][index] = _number(value, name, f"message {index} on {topic}", source, rules.interpolate)
    return columns, np.array([time for time, _ in messages], dtype=np.int64)


def _number(value: Any, name: str, place: str, source: Path, gaps: bool) -> float:
    """Return a value of a message as a number, true as 1; NaN where there is none and gaps are filled."""
    if value is MISSING or value is None:
        if gaps:
            return math.nan
        raise UsageError(f"{source}: '{name}' is {'missing' if value is MISSING else 'null'} in {place}; {GAPS_HINT}")
    if not isinstance(value, int | float):
        found = " ".join(repr(value).split())
        listed = isinstance(value, Sequence) and not isinstance(value, str | bytes)
        inner = f"; name one of its values: {name}[0]" if listed else ""
        raise UsageError(f"{source}: '{name}' is no number in {place}: {found:.40}{inner}")
    try:
        return float(value)
    except OverflowError as error:
        raise UsageError(f"{source}: '{name}' is too large in {place}") from error


def _stamp(value: Any) -> int | None:
    """Return a stamp of seconds and nanoseconds in ns; None of anything else."""
    for parts in STAMPS:
        whole, rest = (value.get(part) if isinstance(value, dict) else getattr(value, part, None) for part in parts)
        if isinstance(whole, int) and isinstance(rest, int):
            return whole * 10**9 + rest
    return None


def _unknown_name(name: str, known: list[str], topic: str, found: Scan, source: Path) -> UsageError:
    """Return the error of a name that is not in the messages of a topic; it says on which other topic it is."""
    refusal = unknown("name", name, known, f"the messages on {topic} of {source}")
    for other in found.channels.values():
        with suppress(UsageError, Damaged, StopIteration):
            parse, get = _decoder(found, other, str(source))
            if other.topic != topic and get(parse(next(_messages(found, other, source))[1], 0), name) is not MISSING:
                return UsageError(f"{refusal}; '{name}' is on another topic: write {{column: {name}, topic: {other.topic}}}")
    return refusal


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
        f"{where}: the messages on {channel.topic} are in '{channel.message_encoding}'; json and protobuf can be read{CDR}"
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
    for step in STEP.finditer(name):
        if step["name"]:
            content = content.get(step["name"], MISSING) if isinstance(content, dict) else MISSING
        else:
            at = int(step["at"])
            content = content[at] if isinstance(content, list) and at < len(content) else MISSING
    return content


def _parse_protobuf(kind: Any, data: bytes, index: int, where: str) -> Any:
    from google.protobuf.message import DecodeError

    try:
        return kind.FromString(data)
    except DecodeError as error:
        raise UsageError(f"{where}: message {index} is no {kind.DESCRIPTOR.full_name}") from error


def _get_protobuf(content: Any, name: str) -> Any:
    for step in STEP.finditer(name):
        if step["name"]:
            known = getattr(getattr(content, "DESCRIPTOR", None), "fields_by_name", {})
            part = step["name"]
            if part not in known or (known[part].has_presence and not content.HasField(part)):
                return MISSING
            content = getattr(content, part)
        else:
            at = int(step["at"])
            listed = isinstance(content, Sequence) and not isinstance(content, str | bytes)
            content = content[at] if listed and at < len(content) else MISSING
    return content


def _names(content: Any) -> list[str]:
    if isinstance(content, dict):
        return [str(name) for name in content]
    return list(content.DESCRIPTOR.fields_by_name)
