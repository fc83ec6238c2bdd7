"""Columns of the messages of a recording: JSON, protobuf, or those of ROS 2."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any, Protocol

import numpy as np

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.map_values import GAPS_HINT
from hjcamp.records.elsewhere.reader import Column, Table
from hjcamp.records.mcap.chunks import Damaged

MISSING = object()
# A value within a message: pose.x, position[0].
STEP = re.compile(r"\.?(?P<name>[^.[]+)|\[(?P<at>\d+)\]")
# The two parts of a stamp, as ROS 1, ROS 2 and protobuf call them.
STAMPS = (("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec"), ("seconds", "nanos"))
NS = 1e-9
DEEPEST, MOST_LISTED = 8, 64  # of the values in a message that are offered


class Recording(Protocol):
    """A file of messages on topics; ``where`` is its name in refusals."""

    where: str

    def topics(self) -> list[str]:
        """Return the topics, one for each channel."""

    def messages(self, topic: str) -> Iterator[tuple[int, bytes]]:
        """Yield log time (ns) and content of each message on a topic."""

    def parser(self, topic: str) -> Callable[[bytes, int], Any]:
        """Return what makes a message of a topic of its content and its number."""


def read_messages(recording: Recording, rules: ImportMap) -> Table:
    """Return the named values of each message on the topic of ``rules``, with the log times, s.

    A name may lead inwards (``pose.x``, ``position[0]``), or to a stamp of seconds and nanoseconds. A value on a topic of its own
    is brought to the times of these messages: by a line, or as it was last where its field holds its value. Raises UsageError
    for a file or message that cannot be read, a topic or name that is not there.
    """
    wanted: dict[str, dict[str, str]] = {rules.topic: {}}
    for rule in rules.rules.values():
        wanted.setdefault(rule.topic or rules.topic, {})[rule.key] = rule.column
    held = {rule.key for name, rule in rules.rules.items() if name in rules.held}
    source = recording.where
    try:
        read = {topic: _topic(recording, topic, names, rules) for topic, names in wanted.items()}
    except Damaged as fault:
        raise UsageError(f"{source}: {fault}") from fault
    notes: tuple[str, ...] = ()
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
    return Table(columns, at, notes)


def columns_of(recording: Recording, topic: str) -> list[Column]:
    """Return the numbers within the first message of each topic, or of one; topics that cannot be read have none."""
    found: list[Column] = []
    for one in dict.fromkeys(recording.topics()):
        if topic and one != topic:
            continue
        with suppress(UsageError, Damaged, StopIteration):
            content = recording.parser(one)(next(recording.messages(one))[1], 0)
            found += [Column(name, "s" if stamp else "", ("topic", one)) for name, stamp in _numbers_within(content, "", 0)]
    return found


def _numbers_within(value: Any, name: str, depth: int) -> Iterator[tuple[str, bool]]:
    """Yield the names of numbers within a message, and whether each is a stamp."""
    if name and _stamp(value) is not None:
        yield name, True
    elif isinstance(value, bool | int | float):
        yield name, False
    elif isinstance(value, str | bytes) or depth > DEEPEST:
        return
    elif isinstance(value, Sequence):
        for place, one in enumerate(value[:MOST_LISTED]):
            yield from _numbers_within(one, f"{name}[{place}]", depth + 1)
    else:
        with suppress(TypeError):
            for part in names_of(value):
                yield from _numbers_within(value_of(value, part), f"{name}.{part}" if name else part, depth + 1)


def _topic(
    recording: Recording, topic: str, names: dict[str, str], rules: ImportMap
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return the named values of the messages on one topic, and their log times, ns."""
    source = recording.where
    _check_topic(recording, topic, rules.where)
    messages = sorted(recording.messages(topic), key=lambda one: one[0])
    if not messages:
        raise UsageError(f"{source}: there is no message on the topic {topic}")
    parse = recording.parser(topic)
    columns = {key: np.empty(len(messages)) for key in names}
    firsts: dict[str, int] = {}
    for index, (_, data) in enumerate(messages):
        content = parse(data, index)
        for key, name in names.items():
            value = value_of(content, name)
            if value is MISSING and index == 0 and STEP.split(name, maxsplit=1)[1] not in (known := names_of(content)):
                raise _unknown_name(name, known, topic, recording)
            if (ticks := _stamp(value)) is not None:
                value = (ticks - firsts.setdefault(key, ticks)) * NS
            columns[key][index] = _number(value, name, f"message {index} on {topic}", source, rules.interpolate)
    return columns, np.array([time for time, _ in messages], dtype=np.int64)


def _check_topic(recording: Recording, topic: str, where: str) -> None:
    """Raise UsageError for a topic that is not there, or is that of several channels."""
    topics = recording.topics()
    if not topic:
        listed = ", ".join(dict.fromkeys(topics)) or "none"
        raise UsageError(f"{where}: give the topic of {recording.where}: 'topic: NAME', one of {listed}")
    if topic not in topics:
        raise unknown("topic", topic, topics, recording.where)
    if topics.count(topic) > 1:
        raise UsageError(f"{recording.where}: {counted(topics.count(topic), 'channel')} on {topic}; one can be read")


def _number(value: Any, name: str, place: str, source: str, gaps: bool) -> float:
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


def _unknown_name(name: str, known: list[str], topic: str, recording: Recording) -> UsageError:
    """Return the error of a name that is not in the messages of a topic; it says on which other topic it is."""
    refusal = unknown("name", name, known, f"the messages on {topic} of {recording.where}")
    for other in recording.topics():
        with suppress(UsageError, Damaged, StopIteration):
            content = recording.parser(other)(next(recording.messages(other))[1], 0) if other != topic else None
            if content is not None and value_of(content, name) is not MISSING:
                return UsageError(f"{refusal}; '{name}' is on another topic: write {{column: {name}, topic: {other}}}")
    return refusal


def value_of(content: Any, name: str) -> Any:
    """Return a value within a message, ``MISSING`` where there is none."""
    if isinstance(content, dict) and name in content:
        return content[name]
    for step in STEP.finditer(name):
        if step["name"]:
            content = _part(content, step["name"])
        else:
            at = int(step["at"])
            listed = isinstance(content, Sequence) and not isinstance(content, str | bytes)
            content = content[at] if listed and at < len(content) else MISSING
    return content


def _part(content: Any, name: str) -> Any:
    if isinstance(content, dict):
        return content.get(name, MISSING)
    if (kind := getattr(content, "DESCRIPTOR", None)) is not None:
        known = kind.fields_by_name
        there = name in known and (not known[name].has_presence or content.HasField(name))
        return getattr(content, name) if there else MISSING
    return getattr(content, name, MISSING) if name in getattr(content, "__slots__", ()) else MISSING


def names_of(content: Any) -> list[str]:
    """Return the names of what a message holds."""
    if isinstance(content, dict):
        return [str(name) for name in content]
    if (kind := getattr(content, "DESCRIPTOR", None)) is not None:
        return list(kind.fields_by_name)
    return list(getattr(content, "__slots__", ()))
