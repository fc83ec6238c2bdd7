"""What a command finds: streams that are closed or of another encoding, a terminal that obeys what it is told."""

from __future__ import annotations

import io
import os
import sys
from contextlib import suppress
from typing import Any, TextIO

from hjcamp.errors import visible


class Visible:
    """A stream to which control characters are written as escapes: names and metadata of others may hold any.

    Our console, which escapes texts by itself, writes its colours to the stream within, by the name that rich asks for.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.rich_proxied_file = stream

    def write(self, text: str) -> int:
        """Write a text."""
        self._stream.write(visible(text))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def take_streams() -> None:
    """Let both streams take any text, and be there: what was closed would else be the next file that is opened."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name) or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - it is ours until the end
        if isinstance(stream, io.TextIOWrapper):
            with suppress(ValueError):
                stream.reconfigure(errors="backslashreplace")
        setattr(sys, name, Visible(stream))


def begin_in_utf8() -> None:
    """Begin again where the system's language knows no letters but ASCII: names of files could not be written down."""
    if os.name == "posix" and sys.getfilesystemencoding() == "ascii" and not sys.flags.utf8_mode:
        os.environ["PYTHONUTF8"] = "1"
        os.execv(sys.executable, [sys.executable, "-X", "utf8", *sys.orig_argv[1:]])
