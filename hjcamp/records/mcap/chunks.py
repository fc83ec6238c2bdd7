"""Decompress chunks without believing what they declare."""

from __future__ import annotations

import zlib

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.records import Chunk

MOST_CHUNK_BYTES = 64 * 2**20


class Damaged(Exception):  # noqa: N818 - a state of the file; the callers say what it means
    """The bytes are no whole MCAP file; the text says what and where, without the file's name."""


def decompress(chunk: Chunk, position: int, validate_crc: bool = True) -> bytes:
    """Return the records of a chunk; raises Damaged for a wrong length or CRC, and above 64 MiB."""
    size = chunk.uncompressed_size
    if size > MOST_CHUNK_BYTES:
        raise Damaged(f"the chunk at byte {position} declares {size / 2**20:.0f} MiB uncompressed (at most 64)")
    if chunk.compression not in ("", "zstd", "lz4"):
        raise Damaged(f"the chunk at byte {position} is compressed as '{chunk.compression}'; zstd and lz4 can be read")
    data = chunk.data if not chunk.compression else expand(chunk.compression, chunk.data, size)
    if len(data) != size:
        raise Damaged(f"the chunk at byte {position} holds {len(data)} bytes instead of the {size} it declares")
    if validate_crc and chunk.uncompressed_crc and chunk.uncompressed_crc != zlib.crc32(data):
        raise Damaged(f"wrong CRC in the chunk at byte {position}")
    return data


def expand(compression: str, data: bytes, most: int) -> bytes:
    """Return what can be decompressed of ``data``, at most ``most`` bytes and one more."""
    try:
        if compression == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=most + 1))
        # read() stops at its limit whatever size the frame declares
        with zstandard.ZstdDecompressor(max_window_size=MOST_CHUNK_BYTES).stream_reader(data) as reader:
            return reader.read(most + 1)
    except (zstandard.ZstdError, RuntimeError, EOFError, MemoryError, ValueError) as error:
        raise Damaged("a chunk cannot be decompressed") from error
