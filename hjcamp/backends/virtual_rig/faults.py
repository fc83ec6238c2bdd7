"""What can go wrong with a device on a serial line, and when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hjcamp.errors import UsageError, unknown

KINDS = {
    "late": "a sample comes 50 deadlines late, once",
    "late_samples": "ten samples are missed at once",
    "silent": "the device answers no message any more, and obeys none",
    "nan": "the first reading is no number",
    "short": "a sample lacks its last reading",
    "garbled": "a sample with a wrong check sum",
    "stuck": "the first reading repeats itself",
    "range_end": "the first reading stands at 1e12",
    "refuses": "the device answers each message with an error",
    "gone": "the line is closed at the device's end",
}


@dataclass(frozen=True)
class Fault:
    """A fault that begins at ``sample`` of test number ``test``, or of every test where that is 0."""

    kind: str
    sample: int = 0
    test: int = 0


def parse_fault(text: str, kinds: Mapping[str, str] = KINDS) -> Fault:
    """Return the fault written as ``KIND``, ``KIND@SAMPLE`` or ``KIND@SAMPLE#TEST``."""
    rest, _, test = text.partition("#")
    kind, _, sample = rest.partition("@")
    if kind not in kinds:
        raise unknown("fault", kind, kinds, f"'{text}'")
    try:
        return Fault(kind, int(sample or 0), int(test or 0))
    except ValueError:
        raise UsageError(f"fault '{text}': expected KIND@SAMPLE or KIND@SAMPLE#TEST with whole numbers") from None
