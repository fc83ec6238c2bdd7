"""Take what is whole out of a damaged or unfinished file."""

from __future__ import annotations

from bisect import bisect_left
from contextlib import suppress
from dataclasses import dataclass, field

from mcap import records
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from hjcamp.errors import UsageError
from hjcamp.records.mcap.chunks import MOST_CHUNK_BYTES, Damaged, decompress, expand
from hjcamp.records.mcap.samples import SampleDecoder, TooManySamples
from hjcamp.records.mcap.scan import MOST_RECORDS, RECORD_PREFIX, Scan, TooManyRecords, parse, take, walk

NAME_OFFSET = RECORD_PREFIX + 28  # of the compression's name within a chunk record
CHUNK_HEADER_BYTES = 40  # without the name
MOST_FAULTS = 100
HALVINGS = 3  # how often each record may be looked at until the one that is at fault is alone
MOST_CANDIDATES = 1_000_000
COMPRESSION_NAMES = (b"\x04\x00\x00\x00zstd", b"\x03\x00\x00\x00lz4")


@dataclass
class Salvage:
    """What could be read, the faults met on the way, and what the file says it should hold (None: it does not)."""

    found: Scan = field(default_factory=Scan)
    problems: list[str] = field(default_factory=list)
    messages_declared: dict[int, int] | None = None
    lost_spans: list[tuple[int, int]] = field(default_factory=list)  # log times in ns of chunks that are lost
    chunk_starts: list[int] | None = None  # looked for once, at the first fault

    def next_chunk(self, data: bytes, position: int) -> int:
        """Return where a chunk may start, at or after ``position``; the end of the data where there is none."""
        if self.chunk_starts is None:
            self.chunk_starts = chunk_starts(data)
        index = bisect_left(self.chunk_starts, position)
        return self.chunk_starts[index] if index < len(self.chunk_starts) else len(data)


def salvage(data: bytes) -> Salvage:
    """Read every whole record, from the start to the end of the file; after a fault go on at the next chunk."""
    result = Salvage()
    position = len(MCAP0_MAGIC)
    last = len(data) - len(MCAP0_MAGIC) if data.endswith(MCAP0_MAGIC) else len(data)
    for _ in range(MOST_RECORDS):
        if position >= last:
            break
        if len(result.problems) >= MOST_FAULTS:
            result.problems.append(f"given up at byte {position} after {MOST_FAULTS} faults")
            break
        content = position + RECORD_PREFIX
        end = content + int.from_bytes(data[position + 1 : content], "little")
        opcode = data[position]
        if opcode not in Opcode.__members__.values() or end > len(data):
            result.problems.append(f"no whole record at byte {position}")
            after = _chunk_of_unknown_length(data, content, result) if opcode == Opcode.CHUNK else None
            position = after or result.next_chunk(data, position + 1)
            continue
        try:
            if opcode == Opcode.MESSAGE:
                result.found.add_loose(data[position:end])
            elif opcode == Opcode.STATISTICS:
                result.messages_declared = parse(
                    records.Statistics.read, data[content : min(end, content + 1024)]
                ).channel_message_counts
            else:
                take(result.found, opcode, data[content:end], position)
        except Damaged as fault:
            result.problems.append(str(fault))
            if opcode == Opcode.CHUNK:
                _note_lost_span(data, content, result)
        position = end
    with suppress(Damaged):
        result.found.gather_loose()
    return result


def chunk_starts(data: bytes) -> list[int]:
    """Return every place where a chunk may start, sorted, by the name of its compression."""
    starts: list[int] = []
    for name in COMPRESSION_NAMES:
        at = data.find(name)
        while at >= 0 and len(starts) < MOST_CANDIDATES:
            if at >= NAME_OFFSET and data[at - NAME_OFFSET] == Opcode.CHUNK:
                starts.append(at - NAME_OFFSET)
            at = data.find(name, at + 1)
    return sorted(starts)


def _chunk_of_unknown_length(data: bytes, content: int, result: Salvage) -> int | None:
    """Read a chunk whose record length is wrong or runs past the end, by the length it gives for its data.

    Returns where it ends; None where it is not whole: then its first messages are kept if it is the file's last.
    """
    try:
        chunk = parse(records.Chunk.read, data[content : content + MOST_CHUNK_BYTES])
        with suppress(Damaged):
            result.found.add_stretch(decompress(chunk, content - RECORD_PREFIX))
            return content + CHUNK_HEADER_BYTES + len(chunk.compression) + len(chunk.data)
        _note_lost_span(data, content, result)
        if chunk.compression and chunk.uncompressed_size <= MOST_CHUNK_BYTES and result.next_chunk(data, content) == len(data):
            result.found.add_stretch(_whole_records(expand(chunk.compression, chunk.data, chunk.uncompressed_size)))
    except Damaged as fault:
        result.problems.append(str(fault))
    return None


def _whole_records(stretch: bytes) -> bytes:
    last = 0
    try:
        for _, _, last in walk(stretch, 0, len(stretch)):  # noqa: B007 - its last value is the answer
            pass
    except Damaged:
        return stretch[:last]
    return stretch


def _note_lost_span(data: bytes, content: int, result: Salvage) -> None:
    start, end = (int.from_bytes(data[content + at : content + at + 8], "little") for at in (0, 8))
    if start <= end:
        result.lost_spans.append((start, end))


def decode_salvage(result: Salvage, where: str) -> SampleDecoder:
    """Return a decoder with every message that is a sample; adds the faults of the others to the problems."""
    decoder = SampleDecoder(result.found, where)
    result.found.records_left = HALVINGS * MOST_RECORDS
    waiting = result.found.stretches[::-1]
    while waiting:
        if len(result.problems) >= MOST_FAULTS:
            result.problems.append(f"given up after {MOST_FAULTS} faults")
            break
        stretch = waiting.pop()
        try:
            decoder.add(stretch)
        except (TooManySamples, TooManyRecords) as fault:
            result.problems.append(str(fault).removeprefix(f"{where}: "))
            break
        except (Damaged, UsageError) as fault:
            halves = _halves(stretch, result.found)
            waiting += halves[::-1]  # until only the message that is at fault is left out
            if not halves:
                result.problems.append(str(fault).removeprefix(f"{where}: "))
    return decoder


def _halves(stretch: bytes, found: Scan) -> list[bytes]:
    """Split message records in two; nothing is left to split in a single one, or where a record is not whole."""
    try:
        ends = [end for _, _, end in walk(stretch, 0, len(stretch), found)]
    except Damaged:
        return []
    if len(ends) < 2:
        return []
    middle = ends[len(ends) // 2 - 1]
    return [stretch[:middle], stretch[middle:]]
