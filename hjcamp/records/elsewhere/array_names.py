"""Columns of named arrays, as NumPy writes them: ``q``, ``q[:,1]``, ``q[0,:]``, a field of records ``q.x``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.reader import check_bytes

NAME = re.compile(r"(?P<root>.+?)(?:\.(?P<field>[^.\[\]]+))?(?:\[(?P<at>[\d:,\s]+)\])?")
MOST_WITHIN = 100  # columns of one matrix that are listed


def column_of(source: Path, name: str, arrays: Mapping[str, Any]) -> np.ndarray:
    """Return a column as numbers, times and durations in s; raises UsageError for a name that is not there."""
    value, field, at = _parts(source, name, arrays)
    check_bytes(source, int(np.prod(value.shape, dtype=float)) * value.dtype.itemsize, f"'{name}'")
    if field:
        if field not in (value.dtype.names or ()):
            raise unknown("field", field, value.dtype.names or (), f"'{name}' of {source}")
        value = np.asarray(value[field])
    if at:
        value = _taken(value, at, name, source)
    found = np.asarray(value[()] if not isinstance(value, np.ndarray) else value)
    if found.dtype.kind in "mM":
        found = (found.reshape(-1) - found.reshape(-1)[:1]) / np.timedelta64(1, "ns") * 1e-9
    if found.dtype.kind not in "iufb":
        held = f"records with {', '.join(found.dtype.names)}" if found.dtype.names else f"{found.dtype}, not numbers"
        raise UsageError(f"{source}: '{name}' holds {held}")
    check_one_column(source, name, found, ("[", "]"), "0")
    return found.reshape(-1).astype(np.float64)


def check_one_column(source: Path, name: str, value: np.ndarray, brackets: tuple[str, str], first: str) -> None:
    """Raise ``UsageError`` for a matrix, with its longest columns as a language writes them: its brackets and its first place."""
    if value.ndim < 2 or value.size == max(value.shape):
        return
    longest = [axis for axis in range(value.ndim) if value.shape[axis] == max(value.shape)]
    ways = [
        f"{name}{brackets[0]}{','.join(':' if k == axis else first for k in range(value.ndim))}{brackets[1]}"
        for axis in longest
    ]
    shape = " x ".join(map(str, value.shape))
    raise UsageError(f"{source}: '{name}' is a matrix ({shape}); give one column or row of it: {' or '.join(ways)}")


def columns_within(arrays: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of the columns of numbers and times that arrays hold, those of one value left out."""
    for name in arrays:
        value = arrays[name]
        fields = [one for one in value.dtype.names or () if value.dtype[one].kind in "iufbmM" and value.ndim == 1]
        if fields:
            yield from (f"{name}.{one}" for one in fields)
        elif value.dtype.kind in "iufbmM" and value.size > 1:
            if value.size == max(value.shape):
                yield name
            elif value.ndim == 2 and min(value.shape) <= MOST_WITHIN:
                along = int(np.argmax(value.shape))
                yield from (f"{name}[:,{k}]" if along == 0 else f"{name}[{k},:]" for k in range(value.shape[1 - along]))


def _parts(source: Path, name: str, arrays: Mapping[str, Any]) -> tuple[Any, str, str]:
    """Return the array that a name begins with, the field of its records, and what is taken of it."""
    if name in arrays:
        return arrays[name], "", ""
    parts = NAME.fullmatch(name)
    if parts:
        root, field, at = parts["root"], parts["field"] or "", parts["at"] or ""
        if root in arrays:
            return arrays[root], field, at
        if f"{root}.{field}" in arrays:
            return arrays[f"{root}.{field}"], "", at
    raise unknown("array", name, list(arrays), str(source))


def _taken(value: Any, said: str, name: str, source: Path) -> Any:
    """Return what an index takes of an array, counted from 0."""
    parts = [part.strip() for part in said.split(",")]
    allowed = len(parts) == len(value.shape) and all(
        part == ":" or (part.isdigit() and int(part) < size) for part, size in zip(parts, value.shape, strict=True)
    )
    if not allowed:
        shape = " x ".join(map(str, value.shape))
        raise UsageError(f"{source}: '{name}' is not there; the array is {shape}, counted from 0")
    return value[tuple(slice(None) if part == ":" else int(part) for part in parts)]
