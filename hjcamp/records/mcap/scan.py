"""Walk the records of an MCAP file within strict bounds.

The mcap library decodes the records. Its readers are not used to walk: they take a short record without a word,
unpack message indexes entry by entry, and believe the lengths that a damaged file declares.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TypeVar

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from hjcamp.errors import UsageError
from hjcamp.records.mcap.chunks import Damaged, decompress

METADATA_NAME = "hjcamp.test"
MOST_FILE_BYTES = 256 * 2**20
MOST_UNCOMPRESSED_BYTES = 256 * 2**20
MOST_DESCRIBING_BYTES = 16 * 2**20  # of schemas, channels and metadata together
MOST_METADATA_BYTES = 2**20
MOST_RECORDS = 4_000_000
OTHER_COUNTS = 8  # messages: chunks, their indexes and the like are few
LOOSE_MESSAGES = 4096  # outside chunks, taken together
FOOTER_BYTES = 29
RECORD_PREFIX = 9
T = TypeVar("T")


@dataclass
class Scan:
    """What a file holds: its message records as stretches of bytes, and everything else decoded."""

    stretches: list[bytes] = field(default_factory=list)
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    channels: dict[int, records.Channel] = field(default_factory=dict)
    metadata: list[records.Metadata] = field(default_factory=list)
    attachments: list[records.Attachment] = field(default_factory=list)
    uncompressed_bytes: int = 0
    describing_bytes: int = 0
    metadata_bytes: int = 0
    loose: list[bytes] = field(default_factory=list)
    records_left: int = field(default_factory=lambda: MOST_RECORDS)

    def add_loose(self, message: bytes) -> None:
        """Add a message record that is in no chunk; ``gather_loose`` makes stretches of them."""
        self.loose.append(message)
        if len(self.loose) == LOOSE_MESSAGES:
            self.gather_loose()

    def gather_loose(self) -> None:
        """Put the messages that were in no chunk among the stretches."""
        if self.loose:
            self.add_stretch(b"".join(self.loose))
            self.loose.clear()

    def add_stretch(self, stretch: bytes) -> None:
        """Add the content of a chunk; raises Damaged where all of them together are too large."""
        self.uncompressed_bytes += len(stretch)
        if self.uncompressed_bytes > MOST_UNCOMPRESSED_BYTES:
            raise Damaged("the messages take more than 256 MiB uncompressed, too much for a test log")
        self.stretches.append(stretch)


def load(path: Path) -> bytes:
    """Return the bytes of a file; raises UsageError where it is missing, no file, empty, too large or no MCAP file."""
    try:
        if not path.exists():
            raise UsageError(f"{path}: there is no such file")
        if not path.is_file():
            raise UsageError(f"{path}: is not a file")
        if (size := path.stat().st_size) > MOST_FILE_BYTES:
            raise UsageError(f"{path}: {size / 2**20:.0f} MiB is too large for a test log (at most 256 MiB)")
        data = path.read_bytes()
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    if not data:
        raise UsageError(f"{path}: the file is empty")
    if not data.startswith(MCAP0_MAGIC):
        raise UsageError(f"{path}: is not an MCAP file (a CSV file becomes a test log with hjcamp import)")
    return data


class TooManyRecords(Damaged):
    """The file holds more records than a test can have."""


def walk(data: bytes, start: int, end: int, found: Scan | None = None) -> Iterator[tuple[int, int, int]]:
    """Yield opcode, first byte and end of the content of each record between ``start`` and ``end``.

    Raises `Damaged` for what is no record, and `TooManyRecords` where ``found`` has had too many in its whole file.
    """
    position, found = start, found or Scan()
    while position < end:
        found.records_left -= 1 if data[position] == Opcode.MESSAGE else OTHER_COUNTS
        if found.records_left < 0:
            raise TooManyRecords(
                f"more than {MOST_RECORDS} messages, or {MOST_RECORDS // OTHER_COUNTS} other records, too many for a test log"
            )
        if not data[position]:
            raise Damaged(f"byte {position} begins no record")
        content = position + RECORD_PREFIX
        length = int.from_bytes(data[position + 1 : content], "little")
        if content + length > end:
            raise Damaged(f"the record at byte {position} is longer than what holds it")
        yield data[position], content, content + length
        position = content + length


def parse(kind: Callable[[ReadDataStream], T], content: bytes) -> T:
    """Decode the content of one record with the mcap library."""
    try:
        return kind(ReadDataStream(BytesIO(content)))
    except (McapError, struct.error, UnicodeDecodeError, OverflowError, MemoryError) as error:
        raise Damaged(f"a record cannot be decoded ({type(error).__name__})") from error


def scan(data: bytes, validate_crcs: bool = True) -> Scan:
    """Return everything in a whole file; raises Damaged at the first thing that is not as it must be."""
    if not data.endswith(MCAP0_MAGIC) or len(data) < 2 * len(MCAP0_MAGIC) + FOOTER_BYTES:
        raise Damaged("the file is truncated or was never finished")
    found = Scan()
    data_end = None
    for opcode, start, end in walk(data, len(MCAP0_MAGIC), len(data) - len(MCAP0_MAGIC), found):
        if opcode == Opcode.DATA_END:
            data_end = start
        elif opcode == Opcode.MESSAGE:
            found.add_loose(data[start - RECORD_PREFIX : end])
        elif data_end is None or opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            take(found, opcode, data[start:end], start, validate_crcs)
    if data_end is None:
        raise Damaged("the file ends without an end of its data section")
    found.gather_loose()
    if validate_crcs:
        _check_sections(data, data_end)
    return found


def take(found: Scan, opcode: int, content: bytes, position: int, validate_crcs: bool = True) -> None:
    """Add one record of the data section, other than a loose message, to ``found``."""
    if opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
        found.describing_bytes += len(content)
        if found.describing_bytes > MOST_DESCRIBING_BYTES:
            raise Damaged("schemas, channels and metadata take more than 16 MiB, too much for a test log")
    if opcode == Opcode.METADATA:
        found.metadata_bytes += len(content)
        if found.metadata_bytes > MOST_METADATA_BYTES:
            raise Damaged("its metadata take more than 1 MiB, too much for a test log")
    if opcode == Opcode.CHUNK:
        found.add_stretch(decompress(parse(records.Chunk.read, content), position, validate_crcs))
    elif opcode == Opcode.SCHEMA:
        schema = parse(records.Schema.read, content)
        found.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        channel = parse(records.Channel.read, content)
        found.channels[channel.id] = channel
    elif opcode == Opcode.METADATA:
        found.metadata.append(parse(records.Metadata.read, content))
    elif opcode == Opcode.ATTACHMENT:
        attachment = parse(records.Attachment.read, content)
        checksum = int.from_bytes(content[-4:], "little")
        if validate_crcs and checksum and checksum != zlib.crc32(content[:-4]):
            raise Damaged(f"wrong CRC in attachment '{attachment.name}' at byte {position}")
        found.attachments.append(attachment)


def _check_sections(data: bytes, data_end: int) -> None:
    """Compare the checksums of the data section and of the summary, where the file has them."""
    checksum = int.from_bytes(data[data_end : data_end + 4], "little")
    if checksum and checksum != zlib.crc32(memoryview(data)[: data_end - RECORD_PREFIX]):
        raise Damaged("wrong CRC of the data section")
    footer = len(data) - len(MCAP0_MAGIC) - FOOTER_BYTES
    if data[footer] != Opcode.FOOTER:
        raise Damaged("the file ends without a footer")
    content = parse(records.Footer.read, data[footer + RECORD_PREFIX :])
    start = content.summary_start or footer
    if not data_end < start <= footer:
        raise Damaged("the footer points to a summary outside the file")
    if content.summary_crc and content.summary_crc != zlib.crc32(data[start : footer + FOOTER_BYTES - 4]):
        raise Damaged("wrong CRC of the summary")


def metadata_of(found: Scan) -> dict[str, str]:
    """Return the metadata record of the test; empty where the file has none."""
    merged: dict[str, str] = {}
    for record in found.metadata:
        if record.name == METADATA_NAME:
            merged |= record.metadata
    return merged
