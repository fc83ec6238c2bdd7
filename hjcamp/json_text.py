"""Read JSON that somebody gave: what is none, too long or nested too deeply is one message, before anything uses it."""

from __future__ import annotations

import json
import re
from itertools import accumulate
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.storage import check_is_file, shown_path

MOST_BYTES = 200_000_000
DEEPEST = 100
_TEXTS = re.compile(rb'"(?:[^"\\]|\\.)*"', re.DOTALL)
_BRACKETS = re.compile(rb"[\[{}\]]")
# Half of a character: text that no file takes.
_HALF = re.compile(rb"\\u[dD][89a-fA-F]")


class NotJson(UsageError, ValueError):  # noqa: N818 - a state of the file
    """The bytes are no JSON that can be used."""


def read_json(path: Path) -> Any:
    """Return what a JSON file holds as plain values; raises `NotJson` as `json_values` does, and where it cannot be read."""
    try:
        check_is_file(path)
        with path.open("rb") as stream:
            content = stream.read(MOST_BYTES + 1)
    except UsageError as error:
        raise NotJson(str(error)) from None
    except OSError as error:
        raise NotJson(f"{shown_path(path)}: cannot be read: {error.strerror or error}") from error
    return json_values(content, shown_path(path))


def json_values(content: bytes, where: str = "JSON") -> Any:
    """Return what a text of JSON holds; raises `NotJson` for what is none, nested too deeply, too long or no Unicode."""
    if len(content) > MOST_BYTES:
        raise NotJson(f"{where}: is longer than {MOST_BYTES / 1e6:g} MB")
    depths = accumulate(1 if found[0] in b"[{" else -1 for found in _BRACKETS.finditer(_TEXTS.sub(b"", content)))
    if max(depths, default=0) > DEEPEST:
        raise NotJson(f"{where}: is nested too deeply (at most {DEEPEST} levels)")
    try:
        found = json.loads(content.decode("utf-8-sig"), parse_constant=_no_number)
        if _HALF.search(content):
            json.dumps(found, ensure_ascii=False).encode()
    # A number too long to be read is a ValueError of Python's own.
    except (ValueError, RecursionError, MemoryError) as error:
        raise NotJson(f"{where}: this is no JSON: {error}") from None
    return found


def _no_number(text: str) -> Any:
    raise ValueError(f"{text} is no number of JSON")
