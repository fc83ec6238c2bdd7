"""The fixed bytes of a sample: an MCAP message record around a protobuf message of doubles.

opcode 1 | length 8 | channel 2 | sequence 4 | log time 8 | publish time 8 | (tag 1, from field 16 on 2 | double 8) per field
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

MESSAGE_OPCODE = 5
RECORD_PREFIX = 9  # opcode and length
MESSAGE_PREFIX = 22  # channel, sequence and the two times
DOUBLE_WIRE_TYPE = 1
VALUE_BYTES = 8
BYTES_PER_FIELD, MOST_BYTES_PER_FIELD = 9, 10
SHORT_TAGS = 15  # the largest number whose tag is one byte
LONG_TAGS = 2047  # the largest whose tag is two


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
        parts += [(f"tag{number}", "u1" if number <= SHORT_TAGS else "<u2"), (f"value{number}", "<f8")]
    return np.dtype(parts)


def tag(number: int) -> int:
    """Return the protobuf tag of a double with this field number as its bytes are read, little end first."""
    key = number << 3 | DOUBLE_WIRE_TYPE
    return key if number <= SHORT_TAGS else (key & 0x7F) | 0x80 | key >> 7 << 8


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
    if length > MESSAGE_PREFIX + LONG_TAGS * MOST_BYTES_PER_FIELD or remaining % (length + RECORD_PREFIX):
        return None
    payload = start + RECORD_PREFIX + MESSAGE_PREFIX
    numbers = _numbers(stretch[payload : start + RECORD_PREFIX + length])
    if not numbers or len(set(numbers)) != len(numbers):
        return None
    records = np.frombuffer(stretch, record_dtype(numbers), offset=start)
    constant = {"opcode": MESSAGE_OPCODE, "length": length, "channel": records["channel"][0]}
    constant |= {f"tag{number}": tag(number) for number in numbers}
    if any((records[name] != value).any() for name, value in constant.items()):
        return None
    return numbers, records


def _numbers(message: bytes) -> tuple[int, ...]:
    """Return the field numbers of a message that holds doubles alone; none where it does not."""
    numbers: list[int] = []
    at = 0
    while at < len(message):
        key, at = message[at], at + 1
        if key & 0x80 and at < len(message):
            key, at = key & 0x7F | message[at] << 7, at + 1
        number = key >> 3
        # Written otherwise (a longer tag, another kind of value) it is left to the general decoder.
        if not 1 <= number <= LONG_TAGS or not message.startswith(written := _tag_bytes(number), at - len(written)):
            return ()
        numbers.append(number)
        at += VALUE_BYTES
    return tuple(numbers) if at == len(message) else ()


def _tag_bytes(number: int) -> bytes:
    return tag(number).to_bytes(1 if number <= SHORT_TAGS else 2, "little")
