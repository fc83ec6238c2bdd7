"""The text protocol of a rig on a serial line: one line, one message, each with its check sum (docs/rig_protocol.md)."""

from __future__ import annotations

from collections.abc import Sequence

VERSION = "1"
LONGEST_LINE = 4096
HELLO, READ, SAMPLE, WRITE, SAFE, ERROR = "H", "R", "S", "W", "Z", "E"


class BadLine(ValueError):  # noqa: N818 - it is a state of the line
    """A line that is no message: its check sum is wrong, or it is cut off."""


def check_sum(text: bytes) -> int:
    """Return the exclusive or of all bytes, as NMEA 0183 has it."""
    found = 0
    for byte in text:
        found ^= byte
    return found


def message(word: str, *parts: object) -> bytes:
    """Return a message as it goes over the line: its parts, ``*`` and the check sum in two hexadecimal digits."""
    text = " ".join((word, *(one if isinstance(one, str) else f"{one:.17g}" for one in parts))).encode("ascii", "replace")
    return text + b"*%02X\n" % check_sum(text)


def parts_of(line: bytes) -> list[str]:
    """Return the parts of a message; raises ``BadLine``."""
    text, star, told = line.strip().rpartition(b"*")
    try:
        if not star or len(told) != 2 or int(told, 16) != check_sum(text) or not text:
            raise BadLine(f"no message: {line[:60]!r}")
        return text.decode("ascii").split(" ")
    except ValueError:
        raise BadLine(f"no message: {line[:60]!r}") from None


def numbers(parts: Sequence[str]) -> list[float]:
    """Return parts as numbers; NaN stays NaN, what is no number raises ``BadLine``."""
    try:
        return [float(one) for one in parts]
    except ValueError:
        raise BadLine(f"no numbers: {' '.join(parts)[:60]!r}") from None
