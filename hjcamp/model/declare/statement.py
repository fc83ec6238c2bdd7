"""A line of a plant's equations."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Statement:
    """One line of the equations: ``target`` = ``expression``; ``mark`` is "slot", "signal", "rate" or "plain".

    ``line`` is its number in the plant's file.
    """

    target: str
    expression: str
    mark: str
    unit: str = ""
    text: str = ""
    line: int = 0
