"""The fixed bytes of a sample: an MCAP message record around a protobuf message of doubles.

opcode 1 | length 8 | channel 2 | sequence 4 | log time 8 | publish time 8 | (tag 1 | double 8) per field
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

MESSAGE_OPCODE = 5
RECORD_PREFIX = 9  # opcode and length
MESSAGE_PREFIX = 22  # channel, sequence and the two times
DOUBLE_WIRE_TYPE = 1
BYTES_PER_FIELD = 9
MOST_FIELDS = 15  # a larger number needs a tag of two bytes


@lru_cache(maxsize=64)
def record_dtype(numbers: tuple[int, ...]) -> np.dtype:
    """Return the packed layout of one message record with the protobuf fields ``numbers``, in this order."""
    parts: list[tuple[str, str]] = [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
    for number in numbers:
        parts += [(f"tag{number}", "u1"), (f"value{number}", "<f8")]
    return np.dtype(parts)


def tag(number: int) -> int:
    """Return the protobuf tag byte of a double with this field number."""
    return number << 3 | DOUBLE_WIRE_TYPE


def encode(
    numbers: Sequence[int], columns: Sequence[np.ndarray], log_time: np.ndarray, channel: int, first_sequence: int
) -> np.ndarray:
    """Return the message records, shape (samples,), of columns of shape (samples,); times in ns."""
    dtype = record_dtype(tuple(numbers))
    records = np.empty(len(log_time), dtype)
    records["opcode"] = MESSAGE_OPCODE
    records["length"] = dtype.itemsize - RECORD_PREFIX
    records["channel"] = channel
    records["sequence"] = np.arange(first_sequence, first_sequence + len(log_time))
    records["log_time"] = log_time
    records["publish_time"] = log_time
    for number, values in zip(numbers, columns, strict=True):
        records[f"tag{number}"] = tag(number)
        records[f"value{number}"] = values
    return records


def decode(stretch: bytes, start: int) -> tuple[tuple[int, ...], np.ndarray] | None:
    """Return field numbers and records where all bytes from ``start`` on share one fixed layout, else None."""
    remaining = len(stretch) - start
    if remaining < RECORD_PREFIX + MESSAGE_PREFIX + BYTES_PER_FIELD:
        return None
    length = int.from_bytes(stretch[start + 1 : start + RECORD_PREFIX], "little")
    payload_length = length - MESSAGE_PREFIX
    if not 0 < payload_length <= MOST_FIELDS * BYTES_PER_FIELD or payload_length % BYTES_PER_FIELD:
        return None
    if remaining % (length + RECORD_PREFIX):
        return None
    payload = start + RECORD_PREFIX + MESSAGE_PREFIX
    tags = stretch[payload : payload + payload_length : BYTES_PER_FIELD]
    numbers = tuple(byte >> 3 for byte in tags)
    if len(set(numbers)) != len(numbers) or any(byte != tag(byte >> 3) or not 8 <= byte < 128 for byte in tags):
        return None
    records = np.frombuffer(stretch, record_dtype(numbers), offset=start)
    constant = {"opcode": MESSAGE_OPCODE, "length": length, "channel": records["channel"][0]}
    constant |= {f"tag{number}": tag(number) for number in numbers}
    if any((records[name] != value).any() for name, value in constant.items()):
        return None
    return numbers, records
