"""What became of a test of a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """What became of a test: ``state`` done or failed; ``stops`` is an exit code where the run cannot go on.

    ``left`` is there where the backend may be looked at again after a fault; ``facts`` is what it said of itself; ``error``
    is the channel with a reference and its RMS error.
    """

    test: str
    condition: str
    state: str
    seconds: float
    message: str = ""
    detail: str = ""
    stops: int | None = None
    left: Any = None
    facts: dict[str, str] = field(default_factory=dict)
    error: tuple[str, float] | None = None
