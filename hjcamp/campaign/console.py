"""The console that runs and commands print to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

WIDTH_OF_FILES = 160


def make_console(quiet: bool = False) -> Console:
    """Return a console, ``quiet``: mute; on a terminal lines end between words, a file has them whole and room for any table."""
    from rich.console import Console

    class Uncut(Console):
        def print(self, *objects: Any, **options: Any) -> None:
            super().print(*objects, **{"crop": False, **options})

    console = Uncut(highlight=False, quiet=quiet)
    if not console.is_terminal:
        console.soft_wrap = True
        console.width = max(console.width, WIDTH_OF_FILES)
    return console
