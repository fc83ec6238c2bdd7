"""Damaged and hostile files: each is read, recovered or refused with a message, within bounds."""

from __future__ import annotations

import random
import struct
import time
import zlib
from collections import Counter
from pathlib import Path

import pytest
import zstandard
from log_makers import json_file, make_columns, make_log, rows
from mcap.writer import MCAP0_MAGIC, CompressionType

from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.mcap import salvage, scan
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log, verify_log
from hjcamp.records.write import write_log

# A guard against endless work, not a measure of speed: machines are shared.
LONGEST_SECONDS = 20.0


def whole_logs(folder: Path) -> list[bytes]:
    """Return logs of both encodings, chunked and not."""
    write_log(folder / "ours.mcap", make_log(samples=700, before=100))
    samples = rows(make_columns(samples=150))
    return [
        (folder / "ours.mcap").read_bytes(),
        json_file(samples),
        json_file(samples, compression=CompressionType.LZ4),
        json_file(samples, use_chunking=False),
        json_file(samples, compression=CompressionType.NONE, enable_crcs=False),
    ]


def damage(content: bytes, others: list[bytes], chance: random.Random) -> bytes:
    """Return ``content`` with flipped bytes, cut, with a part missing, repeated or taken from another file."""
    kind = chance.randrange(6)
    data = bytearray(content)
    first, second = sorted(chance.randrange(len(data)) for _ in range(2))
    if kind == 0:
        for _ in range(chance.choice((1, 1, 2, 5, 30))):
            data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    elif kind == 1:
        del data[first:]
    elif kind == 2:
        del data[first : min(second, first + chance.choice((1, 8, 100, 5000)))]
    elif kind == 3:
        data[first:first] = data[first:second]
    elif kind == 4:
        other = chance.choice(others)
        data[first:second] = other[first:second]
    else:
        data[first : first + 8] = struct.pack("<Q", chance.choice((0, 1, 2**31, 2**40, 2**63, 2**64 - 1)))
    return bytes(data)


def try_damaged(folder: Path, files: int, seed: int) -> tuple[Counter[str], float]:
    """Damage, read, verify and recover ``files`` logs; return what became of them and the longest time in s."""
    chance = random.Random(seed)
    originals = whole_logs(folder)
    outcomes: Counter[str] = Counter()
    longest = 0.0
    path, saved = folder / "damaged.mcap", folder / "saved.mcap"
    for _ in range(files):
        path.write_bytes(damage(chance.choice(originals), originals, chance))
        saved.unlink(missing_ok=True)
        began = time.perf_counter()
        try:
            read_log(path)
            outcome = "read"
        except UsageError as refusal:
            assert "\n" not in str(refusal) and str(path) in str(refusal)
            try:
                recover_log(path, saved)
                outcome = "recovered"
            except HjcampError as final:
                assert "\n" not in str(final)
                assert not saved.exists()
                outcome = "refused"
            try:
                verify_log(path)
            except UsageError:
                assert outcome == "refused"
        longest = max(longest, time.perf_counter() - began)
        outcomes[outcome] += 1
        assert not saved.with_name("saved.mcap.part").exists()
    return outcomes, longest


def test_damaged_files(tmp_path: Path) -> None:
    outcomes, longest = try_damaged(tmp_path, files=300, seed=2026)
    assert min(outcomes["read"], outcomes["recovered"], outcomes["refused"]) > 5, outcomes
    assert longest < LONGEST_SECONDS


def record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def chunk(data: bytes, declared: int, compression: bytes = b"zstd") -> bytes:
    head = struct.pack("<QQQII", 0, 0, declared, 0, len(compression)) + compression
    return record(6, head + struct.pack("<Q", len(data)) + data)


def wrapped(*parts: bytes) -> bytes:
    """Return an MCAP file with these records in its data section and an empty summary."""
    header = record(1, struct.pack("<I", 0) * 2)
    footer = struct.pack("<BQQQ", 2, 20, 0, 0)
    tail = footer + struct.pack("<I", zlib.crc32(footer))
    return MCAP0_MAGIC + header + b"".join(parts) + record(15, bytes(4)) + tail + MCAP0_MAGIC


ZEROS = bytes(80 * 2**20)
BOMB = zstandard.ZstdCompressor(level=1).compress(ZEROS)
STREAM_BOMB = zstandard.ZstdCompressor(level=1, write_content_size=False).compress(ZEROS)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (wrapped(chunk(BOMB, 80 * 2**20)), "declares 80 MiB uncompressed"),
        (wrapped(chunk(BOMB, 1000)), "holds 1001 bytes instead of the 1000"),
        (wrapped(chunk(STREAM_BOMB, 1000)), "holds 1001 bytes instead of the 1000"),
        (wrapped(chunk(b"", 2**63)), "uncompressed"),
        (wrapped(chunk(b"junk", 4)), "cannot be decompressed"),
        (wrapped(chunk(b"junk" * 8, 32, b"lz4")), "cannot be decompressed"),
        (wrapped(chunk(b"junk", 4, b"brotli")), "compressed as 'brotli'"),
        (wrapped(struct.pack("<BQ", 6, 2**62)), "longer than what holds it"),
        (wrapped(record(12, struct.pack("<II", 0, 2**32 - 1))), "cannot be decoded"),
        (wrapped(record(12, bytes(4) + struct.pack("<I", 17 * 2**20) + bytes(17 * 2**20))), "more than 16 MiB"),
        (wrapped(record(12, bytes(4) + struct.pack("<I", 2 * 2**20) + bytes(2 * 2**20))), "more than 1 MiB"),
        (wrapped(*[record(12, bytes(4) + struct.pack("<I", 10**5) + bytes(10**5))] * 11), "more than 1 MiB"),
        (wrapped(record(5, b"short")), "shorter than its own header"),
        (wrapped(record(5, bytes(40))), "belongs to no channel"),
        (wrapped(), "no topic /test/sample; found: no channel"),
    ],
)
def test_hostile_files_are_refused_within_bounds(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "hostile.mcap"
    path.write_bytes(content)
    began = time.perf_counter()
    with pytest.raises(UsageError, match=message):
        read_log(path)
    with pytest.raises(UsageError, match="nothing can be recovered"):
        recover_log(path, tmp_path / "saved.mcap")
    assert not verify_log(path).whole
    assert time.perf_counter() - began < LONGEST_SECONDS


def test_many_false_chunks_end_soon(tmp_path: Path) -> None:
    path = tmp_path / "false.mcap"
    false = struct.pack("<BQ", 6, 2**60) + bytes(28) + b"\x04\x00\x00\x00zstd"
    path.write_bytes(MCAP0_MAGIC + false * 200_000)
    began = time.perf_counter()
    with pytest.raises(UsageError, match="nothing can be recovered"):
        recover_log(path, tmp_path / "saved.mcap")
    assert verify_log(path).problems[-1].startswith("given up at byte")
    assert time.perf_counter() - began < LONGEST_SECONDS


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    with open(tmp_path / "large.mcap", "wb") as stream:
        stream.truncate(300 * 2**20)
    with pytest.raises(UsageError, match="300 MiB is too large for a test log"):
        read_log(tmp_path / "large.mcap")


def many_records(record: bytes, compressed: bool = True, chunks: int = 2, size: int = 60 * 2**20) -> bytes:
    """Return a small file whose chunks of ``size`` bytes declare many records, each ``record``."""
    content = record * (size // len(record))
    data = zstandard.ZstdCompressor(level=3).compress(content) if compressed else content
    name = b"zstd" if compressed else b""
    chunk = struct.pack("<QQQII", 0, 1, len(content), 0, len(name)) + name + struct.pack("<Q", len(data)) + data
    body = b"".join(struct.pack("<BQ", 6, len(chunk)) + chunk for _ in range(chunks))
    header = struct.pack("<BQ", 1, 8) + bytes(8)
    footer = struct.pack("<BQ", 15, 4) + bytes(4) + struct.pack("<BQ", 2, 20) + bytes(20)
    return MCAP0_MAGIC + header + body + footer + MCAP0_MAGIC


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (bytes(9), "begins no record"),
        (struct.pack("<BQ", 0x80, 0), "or 50000 other records"),
        (struct.pack("<BQ", 7, 0), "or 50000 other records"),
        (struct.pack("<BQHIQQ", 5, 22, 1, 0, 0, 0), "belongs to no channel"),
    ],
    ids=["zeros", "private", "indexes", "messages"],
)
def test_records_without_end_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record: bytes, said: str) -> None:
    # a tenth of bytes, records and time; what is not bounded takes as many times longer
    assert scan.MOST_RECORDS == 4_000_000
    for module in (scan, salvage):
        monkeypatch.setattr(module, "MOST_RECORDS", 400_000)
    path = tmp_path / "many.mcap"
    path.write_bytes(many_records(record, size=6 * 2**20))
    assert path.stat().st_size < 20_000
    began = time.process_time()
    with pytest.raises(UsageError, match=said):
        read_log(path)
    found = verify_log(path)
    assert not found.whole and said in found.problems[0]
    with pytest.raises(UsageError, match="nothing can be recovered"):
        recover_log(path, tmp_path / "saved.mcap")
    assert time.process_time() - began < LONGEST_SECONDS / 10
