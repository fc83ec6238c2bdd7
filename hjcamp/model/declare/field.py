"""One field of a plant's logs, and the two that every plant has."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """One field of a sample: name, unit as written in the log, whether every log must have it, meaning.

    ``also`` are units of another quantity in which it may be imported, each with its size in the field's unit.
    """

    name: str
    unit: str
    required: bool
    text: str
    also: tuple[tuple[str, float], ...] = ()


TIME = Field("time_s", "s", True, "0 at the first sample of the command phase; negative before")
PHASE = Field("phase", "1", False, "0 preload, 1 pressure adjustment, 2 rest, 3 command and control, 4 release")
