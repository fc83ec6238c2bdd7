"""A duration in words."""

from __future__ import annotations


def duration_text(seconds: float) -> str:
    """Return a duration as ``3 min 16 s``."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    parts = [(hours, "h"), (minutes, "min"), (rest, "s")]
    return " ".join(f"{value} {unit}" for value, unit in parts if value) or "0 s"
