"""Bash splits words at ``=`` and ``:``: they are put together before completion, and taken apart after it."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Callable
from typing import Any

BREAKS = "=:"


def complete_for_bash(complete: Callable[[], Any]) -> int:
    """Answer bash, which splits words at ``=`` and ``:``: whole words go to ``complete``, the last piece comes back."""
    pieces = os.environ.get("COMP_WORDS", "").split("\n")
    try:
        place = int(os.environ.get("COMP_CWORD", ""))
    except ValueError:
        return 0
    words, before = whole_words(pieces[: place + 1])
    os.environ |= {"COMP_WORDS": "\n".join(words), "COMP_CWORD": str(len(words) - 1)}
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
        complete()
    lines = list(dict.fromkeys(out.getvalue().splitlines()))
    print("\n".join(line.removeprefix(before) for line in lines), end="")
    return 0


def whole_words(pieces: list[str]) -> tuple[list[str], str]:
    """Return the words that bash has split into ``pieces``, and what stands before the last piece in its word."""
    words: list[list[str]] = []
    glued = False
    for place, piece in enumerate(pieces):
        is_break = bool(piece) and not piece.strip(BREAKS)
        if place > 1 and (is_break or glued):
            words[-1].append(piece)
        else:
            words.append([piece])
        glued = is_break
    last = words[-1] if words else [""]
    return ["".join(word) for word in words], "".join(last if glued else last[:-1])
