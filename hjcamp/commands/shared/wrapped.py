"""Sentences in the terminal, wrapped to its width."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

READABLE = 100


def print_wrapped(console: Console, lines: Sequence[str], indent: int, first: str = "") -> None:
    """Print sentences so that no terminal breaks a word: wrapped to its width, under each other."""
    room = max(min(console.width, READABLE) - indent - 2, 20)
    for number, line in enumerate(lines):
        parts = textwrap.wrap(line, room, break_long_words=False, break_on_hyphens=False)
        for part, text in enumerate(parts or [""]):
            head = first.ljust(indent) if number == 0 and part == 0 else " " * (indent + (2 if part else 0))
            console.print(f"{head}{text}", markup=False)
