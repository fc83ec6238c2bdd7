"""``--live [PORT]`` and ``--no-browser`` of a call that Hydra reads for the rest."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING

from hjcamp.errors import UsageError, shown

if TYPE_CHECKING:
    from hjcamp.live.process import LiveAsk

LIVE, NO_BROWSER = "--live", "--no-browser"


def take_live(arguments: Sequence[str]) -> tuple[list[str], LiveAsk | None]:
    """Return the other arguments, and what is asked of the live page, None where none is.

    Raises ``UsageError`` for a port that is none, and for ``--no-browser`` alone.
    """
    from hjcamp.live.process import HIGHEST_PORT, LiveAsk

    left: list[str] = []
    port: str | None = None
    words = list(arguments)
    while words:
        word = words.pop(0)
        name, equals, value = word.partition("=")
        if name == LIVE:
            # Hydra takes no bare word: one that follows is meant for us
            follows = not equals and words and "=" not in words[0] and words[0][:1] not in "-~+"
            port = value if equals else words.pop(0) if follows else "0"
        elif word != NO_BROWSER:
            left.append(word)
    if port is None:
        if NO_BROWSER in arguments:
            raise UsageError(f"{NO_BROWSER} is for the page of {LIVE}; without it no browser is opened anyway")
        return left, None
    if not (port.isascii() and port.isdigit() and int(port) <= HIGHEST_PORT):
        raise UsageError(f"{LIVE} {shown(port)}: a port from 1 to {HIGHEST_PORT}, or {LIVE} alone for one that is free")
    return left, LiveAsk(int(port), NO_BROWSER not in arguments)


def live(asked: LiveAsk | None) -> AbstractContextManager[None]:
    """Return the context of a run with the page that was asked for, or without one."""
    if asked is None:
        return nullcontext()
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.live.process import live_page

    console = make_console()
    return live_page(asked, lambda text: console.print(f"  {text}", markup=False, soft_wrap=True))
