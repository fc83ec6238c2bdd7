"""JSON messages, as other loggers write them, to columns."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from hjcamp.errors import UsageError

BATCH = 500
_MISSING = object()


class JsonDecoder:
    """Decodes messages that are one JSON object each; other keys than the fields' are ignored."""

    implicit_zero: frozenset[str] = frozenset()

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names

    def decode(
        self, messages: Sequence[bytes], first_sample: int, where: str
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Return per field the values and whether each was there, both of shape (messages,); null is NaN."""
        objects: list[dict[str, Any]] = []
        for start in range(0, len(messages), BATCH):
            objects += _parse(messages[start : start + BATCH], first_sample + start, where)
        values: dict[str, np.ndarray] = {}
        present: dict[str, np.ndarray] = {}
        for name in self._names:
            column = [entry.get(name, _MISSING) for entry in objects]
            kinds = set(map(type, column))
            if kinds == {object}:
                continue
            there = np.array([entry is not _MISSING for entry in column])
            if not kinds <= {float, int, type(None), object}:
                sample = next(
                    index for index, entry in enumerate(column) if type(entry) not in (float, int, type(None), object)
                )
                raise UsageError(f"{where}: '{name}' is no number at sample {first_sample + sample}: {column[sample]!r:.40}")
            if not kinds <= {float, int}:
                column = [entry if type(entry) in (float, int) else np.nan for entry in column]
            try:
                values[name] = np.array(column, dtype=np.float64)
            except OverflowError as error:
                raise UsageError(f"{where}: '{name}' holds a number that is too large") from error
            present[name] = there
        return values, present


def _parse(messages: Sequence[bytes], first_sample: int, where: str) -> list[dict[str, Any]]:
    """Parse messages together, and one by one only where that fails, to say which is wrong."""
    try:
        objects: list[dict[str, Any]] = json.loads(b"[" + b",".join(messages) + b"]")
    except (ValueError, RecursionError):
        objects = []
    if len(objects) == len(messages) and all(type(entry) is dict for entry in objects):
        return objects
    parsed = []
    for index, message in enumerate(messages):
        try:
            entry = json.loads(message)
        except (ValueError, RecursionError) as error:
            raise UsageError(f"{where}: the message of sample {first_sample + index} is not JSON") from error
        if type(entry) is not dict:
            raise UsageError(f"{where}: the message of sample {first_sample + index} is no JSON object")
        parsed.append(entry)
    return parsed
