"""Message records to columns: the fixed layout at once, every other message one by one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from mcap.opcode import Opcode

from hjcamp.errors import UsageError, nearest
from hjcamp.records.log import COMMAND_PHASE, TOPIC
from hjcamp.records.mcap import layout
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.json_samples import JsonDecoder
from hjcamp.records.mcap.protobuf_samples import ProtobufDecoder
from hjcamp.records.mcap.scan import Scan, metadata_of, take, walk
from hjcamp.records.of_plant import table_of

MOST_SAMPLES = 3_600_000  # an hour at 1 ms
MOST_MESSAGE_BYTES = 64 * 1024


class TooManySamples(UsageError):  # noqa: N818 - a state of the file
    """The file holds more samples than a test can have."""


@dataclass
class Samples:
    """Columns of shape (samples,), the log times in ns, and notes on what was left out."""

    columns: dict[str, np.ndarray]
    log_time: np.ndarray
    notes: list[str] = field(default_factory=list)


@dataclass
class Block:
    """The samples of one stretch; ``present`` tells for each field which messages had it."""

    log_time: np.ndarray
    values: dict[str, np.ndarray]
    present: dict[str, np.ndarray]


class SampleDecoder:
    """Collects the samples of one file, stretch by stretch; a stretch that fails leaves no trace."""

    def __init__(self, found: Scan, where: str) -> None:
        self._found = found
        self._where = where
        self._table = table_of(metadata_of(found), where)
        self._blocks: list[Block] = []
        self._decoders: dict[int, JsonDecoder | ProtobufDecoder] = {}
        self.samples = 0

    def add(self, stretch: bytes) -> None:
        """Decode message records; raises Damaged where they are none, UsageError where they are no samples."""
        start = 0
        for opcode, content, end in walk(stretch, 0, len(stretch), self._found):
            if opcode == Opcode.MESSAGE:
                break
            self._register(opcode, stretch[content:end], content)
            start = end
        block = self._fixed(stretch, start) or self._one_by_one(stretch, start)
        if block is not None:
            if self.samples + len(block.log_time) > MOST_SAMPLES:
                raise TooManySamples(f"{self._where}: more than {MOST_SAMPLES} samples are no test (an hour at 1 ms)")
            self.samples += len(block.log_time)
            self._blocks.append(block)

    def _register(self, opcode: int, content: bytes, position: int) -> None:
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            take(self._found, opcode, content, position)

    def _fixed(self, stretch: bytes, start: int) -> Block | None:
        """Decode a stretch in which all messages share one layout of doubles on the sample channel."""
        fixed = layout.decode(stretch, start)
        if fixed is None:
            return None
        numbers, records = fixed
        channel = self._found.channels.get(int(records["channel"][0]))
        if channel is None or channel.topic != TOPIC or channel.message_encoding != "protobuf":
            return None
        decoder = self._decoder(channel.id)
        if not isinstance(decoder, ProtobufDecoder) or not set(numbers) <= set(decoder.by_number):
            return None
        values = {decoder.by_number[number]: np.array(records[f"value{number}"]) for number in numbers}
        there = np.ones(len(records), dtype=bool)
        return Block(records["log_time"].astype(np.uint64), values, dict.fromkeys(values, there))

    def _one_by_one(self, stretch: bytes, start: int) -> Block | None:
        messages: list[bytes] = []
        times: list[int] = []
        sample_channel = None
        for opcode, content, end in walk(stretch, start, len(stretch), self._found):
            if opcode != Opcode.MESSAGE:
                self._register(opcode, stretch[content:end], content)
                continue
            if end - content < layout.MESSAGE_PREFIX:
                raise Damaged("a message is shorter than its own header")
            channel = self._found.channels.get(int.from_bytes(stretch[content : content + 2], "little"))
            if channel is None:
                raise Damaged("a message belongs to no channel")
            if channel.topic != TOPIC:
                continue
            if end - content > MOST_MESSAGE_BYTES:
                raise UsageError(f"{self._where}: message {self.samples + len(messages)} is too large for a sample")
            sample_channel = channel.id
            times.append(int.from_bytes(stretch[content + 6 : content + 14], "little"))
            messages.append(stretch[content + layout.MESSAGE_PREFIX : end])
        if sample_channel is None:
            return None
        self._only_channel()
        values, present = self._decoder(sample_channel).decode(messages, self.samples, self._where)
        return Block(np.array(times, dtype=np.uint64), values, present)

    def _decoder(self, channel_id: int) -> JsonDecoder | ProtobufDecoder:
        if channel_id not in self._decoders:
            channel = self._found.channels[channel_id]
            if channel.message_encoding == "json":
                self._decoders[channel_id] = JsonDecoder(self._table.names)
            elif channel.message_encoding == "protobuf":
                schema = self._found.schemas.get(channel.schema_id)
                self._decoders[channel_id] = ProtobufDecoder(schema, self._table.names, self._where)
            else:
                raise UsageError(f"{self._where}: messages in '{channel.message_encoding}'; protobuf and json can be read")
        return self._decoders[channel_id]

    def _only_channel(self) -> None:
        topics = [channel.topic for channel in self._found.channels.values()]
        if topics.count(TOPIC) > 1:
            raise UsageError(f"{self._where}: {topics.count(TOPIC)} channels on {TOPIC}; a test log has one")
        if TOPIC not in topics:
            match = nearest(TOPIC, topics)
            hint = f" (nearest: {match})" if match else ""
            raise UsageError(f"{self._where}: no topic {TOPIC}{hint}; found: {', '.join(topics) or 'no channel'}")

    def result(self) -> Samples:
        """Return all samples in order of log time; raises UsageError where there are none or a field has holes."""
        self._only_channel()
        if not self.samples:
            raise UsageError(f"{self._where}: holds no messages on {TOPIC}")
        implicit = frozenset[str]().union(*(decoder.implicit_zero for decoder in self._decoders.values()))
        samples = Samples({}, np.concatenate([block.log_time for block in self._blocks]))
        for name in self._table.names:
            column = self._column(name, name in implicit, samples.notes)
            if column is not None:
                samples.columns[name] = column
        if (samples.log_time[1:] < samples.log_time[:-1]).any():
            order = np.argsort(samples.log_time, kind="stable")
            samples.log_time = samples.log_time[order]
            samples.columns = {name: values[order] for name, values in samples.columns.items()}
        return samples

    def _column(self, name: str, implicit_zero: bool, notes: list[str]) -> np.ndarray | None:
        lengths = [len(block.log_time) for block in self._blocks]
        present = np.concatenate(
            [
                block.present[name] if name in block.present else np.zeros(length, dtype=bool)
                for block, length in zip(self._blocks, lengths, strict=True)
            ]
        )
        if not present.any() and not (implicit_zero and name in self._table.required):
            return None
        values = np.concatenate(
            [
                block.values[name] if name in block.values else np.zeros(length)
                for block, length in zip(self._blocks, lengths, strict=True)
            ]
        )
        if present.all() or implicit_zero:
            return values
        if name == "phase":
            values[~present] = COMMAND_PHASE
            return values
        missing = f"'{name}' is missing in {len(present) - int(present.sum())} of {len(present)} messages"
        if name in self._table.required:
            raise UsageError(f"{self._where}: required field {missing}, first at sample {int(np.argmin(present))}")
        notes.append(f"{missing} and was left out")
        return None
