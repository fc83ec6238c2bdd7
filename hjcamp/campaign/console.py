"""The console that runs and commands print to."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

WIDTH_OF_FILES = 160


def make_console(quiet: bool = False) -> Console:
    """Return a console: as wide as the terminal, or wide enough for any table where the output goes to a file; ``quiet``: mute."""
    from rich.console import Console

    console = Console(highlight=False, soft_wrap=True, quiet=quiet)
    if not console.is_terminal:
        console.width = max(console.width, WIDTH_OF_FILES)
    return console
