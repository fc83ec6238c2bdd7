"""The console that runs and commands print to."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING, Any

from hjcamp.errors import visible

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import Console, RenderableType
    from rich.segment import Segment
    from rich.text import Text

WIDTH_OF_FILES = 160


def make_console(quiet: bool = False) -> Console:
    """Return a console, ``quiet``: mute; on a terminal lines end between words, a file has them whole and room for any table.

    A text is no markup, and a terminal obeys nothing in it: names, units and metadata of others may hold anything.
    """
    from rich.console import Console
    from rich.segment import Segment

    class Uncut(Console):
        def print(self, *objects: Any, **options: Any) -> None:
            super().print(*objects, **{"crop": False, **options})

        @property
        def file(self) -> IO[str]:
            # a live bar lays a stream of its own over the one that escapes
            found = super().file
            within: IO[str] = getattr(found, "rich_proxied_file", found)
            return within

        @file.setter
        def file(self, new: IO[str]) -> None:
            self._file = new

        def render_str(self, text: str, **options: Any) -> Text:
            # before a table measures it
            return super().render_str(visible(text), **options)

        def render(self, renderable: RenderableType, options: Any = None) -> Iterable[Segment]:
            for one in super().render(renderable, options):
                yield one if one.control else Segment(visible(one.text), one.style)

    console = Uncut(highlight=False, markup=False, emoji=False, quiet=quiet)
    if not console.is_terminal:
        console.soft_wrap = True
        console.width = max(console.width, WIDTH_OF_FILES)
    return console


def can_move(console: Console) -> bool:
    """Return whether what is shown can be written over: on a terminal that knows how (``TERM=dumb`` does not)."""
    return console.is_terminal and not console.is_dumb_terminal


def bold(text: str, after: str = "", before: str = "") -> Text:
    """Return a text in bold letters between two others."""
    from rich.text import Text

    return Text.assemble(before, (visible(text), "bold"), after)
