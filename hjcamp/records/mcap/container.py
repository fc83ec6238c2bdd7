"""An MCAP file under construction: whole chunks in, indexes and summary at the end.

The record types are the mcap library's. Its writer takes one message a call, which costs 30 ms for a test
of 6 s; here a chunk of message records is handed over as one array of bytes.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import IO

import numpy as np
import zstandard
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from hjcamp.records.mcap.schema import SCHEMA_ENCODING, SCHEMA_NAME

LIBRARY = "hjcamp"
COMPRESSION = "zstd"
COMPRESSION_LEVEL = 1  # level 3: 40 % more time, 1 % fewer bytes
CHANNEL = 1
SCHEMA = 1


def record_bytes(record: records.McapRecord) -> bytes:
    """Return a record with its opcode and length."""
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())


class Container:
    """Writes an MCAP file with one channel to ``stream``; the order of calls is the order in the file."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._offset = 0
        self._checksum = 0
        self._compressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)
        self._schema_and_channel: list[records.McapRecord] = []
        self._chunk_indexes: list[records.ChunkIndex] = []
        self._attachment_indexes: list[records.AttachmentIndex] = []
        self._metadata_indexes: list[records.MetadataIndex] = []
        self._messages = 0
        self._write(MCAP0_MAGIC)
        self._write(record_bytes(records.Header(profile="", library=LIBRARY)))

    def _write(self, data: bytes) -> int:
        """Append to the data section and return the offset at which ``data`` starts."""
        start = self._offset
        self._stream.write(data)
        self._checksum = zlib.crc32(data, self._checksum)
        self._offset += len(data)
        return start

    def add_metadata(self, name: str, metadata: Mapping[str, str]) -> None:
        """Write a metadata record; the keys are sorted so that equal metadata are equal bytes."""
        data = record_bytes(records.Metadata(name=name, metadata={key: str(metadata[key]) for key in sorted(metadata)}))
        start = self._write(data)
        self._metadata_indexes.append(records.MetadataIndex(offset=start, length=len(data), name=name))

    def add_attachment(self, name: str, media_type: str, content: bytes, time_ns: int) -> None:
        """Write a file into the file."""
        data = record_bytes(records.Attachment(create_time=0, log_time=time_ns, name=name, media_type=media_type, data=content))
        start = self._write(data)
        self._attachment_indexes.append(
            records.AttachmentIndex(
                offset=start,
                length=len(data),
                log_time=time_ns,
                create_time=0,
                data_size=len(content),
                name=name,
                media_type=media_type,
            )
        )

    def add_channel(self, topic: str, descriptor: bytes, units: Mapping[str, str]) -> None:
        """Write the schema and the channel with the unit of each field, outside any chunk: they survive the loss of all."""
        schema = records.Schema(id=SCHEMA, name=SCHEMA_NAME, encoding=SCHEMA_ENCODING, data=descriptor)
        said = {f"unit.{name}": unit for name, unit in units.items()}
        channel = records.Channel(id=CHANNEL, topic=topic, message_encoding="protobuf", metadata=said, schema_id=SCHEMA)
        self._schema_and_channel = [schema, channel]
        for record in self._schema_and_channel:
            self._write(record_bytes(record))

    def add_chunk(self, messages: np.ndarray) -> None:
        """Write message records of one fixed layout (see ``layout``) as one chunk with its message index."""
        raw = messages.tobytes()
        times = messages["log_time"]
        chunk = records.Chunk(
            compression=COMPRESSION,
            data=self._compressor.compress(raw),
            message_start_time=int(times.min()),
            message_end_time=int(times.max()),
            uncompressed_crc=zlib.crc32(raw),
            uncompressed_size=len(raw),
        )
        data = record_bytes(chunk)
        start = self._write(data)
        index = np.empty((len(messages), 2), "<u8")
        index[:, 0] = times
        index[:, 1] = np.arange(len(messages)) * messages.dtype.itemsize
        entries = index.tobytes()
        prefix = struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(entries), CHANNEL, len(entries))
        index_start = self._write(prefix + entries)
        self._chunk_indexes.append(
            records.ChunkIndex(
                chunk_length=len(data),
                chunk_start_offset=start,
                compression=COMPRESSION,
                compressed_size=len(chunk.data),
                message_end_time=chunk.message_end_time,
                message_index_length=self._offset - index_start,
                message_index_offsets={CHANNEL: index_start},
                message_start_time=chunk.message_start_time,
                uncompressed_size=len(raw),
            )
        )
        self._messages += len(messages)

    def finish(self) -> None:
        """Write the end of the data, the summary, the footer and their checksums."""
        self._stream.write(record_bytes(records.DataEnd(self._checksum)))
        start = self._offset + 13
        summary = bytearray()
        offsets = bytearray()
        for group in self._summary_groups():
            if group:
                data = b"".join(map(record_bytes, group))
                place = records.SummaryOffset(group_opcode=data[0], group_start=start + len(summary), group_length=len(data))
                offsets += record_bytes(place)
                summary += data
        footer_start = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, start + len(summary))
        tail = bytes(summary + offsets) + footer_start
        self._stream.write(tail + struct.pack("<I", zlib.crc32(tail)) + MCAP0_MAGIC)

    def _summary_groups(self) -> list[list[records.McapRecord]]:
        statistics = records.Statistics(
            attachment_count=len(self._attachment_indexes),
            channel_count=len(self._schema_and_channel) // 2,
            channel_message_counts={CHANNEL: self._messages} if self._messages else {},
            chunk_count=len(self._chunk_indexes),
            message_count=self._messages,
            message_end_time=max((index.message_end_time for index in self._chunk_indexes), default=0),
            message_start_time=min((index.message_start_time for index in self._chunk_indexes), default=0),
            metadata_count=len(self._metadata_indexes),
            schema_count=len(self._schema_and_channel) // 2,
        )
        return [
            self._schema_and_channel[:1],
            self._schema_and_channel[1:],
            [statistics],
            list(self._chunk_indexes),
            list(self._attachment_indexes),
            list(self._metadata_indexes),
        ]
