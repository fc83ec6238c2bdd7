"""Names of columns as MATLAB writes them: variables, fields of structures, columns of matrices, cells."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.array_names import check_one_column

DEEPEST, MOST_WITHIN = 20, 100  # of structures, of columns of a matrix that are listed
# A name as MATLAB writes it: rec.Y(2).Data, q(:,2), m(1,:), c{3}.
STEP = re.compile(r"\.?(?P<name>[^.({]+)|\((?P<at>[\d:,\s]+)\)|\{(?P<cell>[\d,\s]+)\}")


def column_named(source: Path, name: str, content: dict[str, Any], variables: list[str]) -> np.ndarray:
    """Return one variable, a field of a struct (``data.q``), or a column or row of a matrix (``q(:,2)``) as numbers."""
    steps = list(STEP.finditer(name))
    root = steps[0]["name"] if steps and steps[0].start() == 0 and steps[0]["name"] else name
    if root not in content:
        raise unknown("variable", root, variables, str(source))
    if "".join(step[0] for step in steps) != name:
        raise UsageError(f"{source}: '{name}' cannot be read as a name; write it as MATLAB does: rec.Y(2).Data, q(:,2)")
    value, within = np.asarray(content[root]), root
    for step in steps[1:]:
        if step["name"]:
            value = _field(value, step["name"], f"'{within}' of {source}")
        else:
            value = _part(value, step["at"] or step["cell"], f"'{within}{step[0]}'", f"'{within}'", source)
            if step["cell"] and value.dtype == object and value.size == 1:
                value = np.asarray(value.reshape(-1)[0])
        within += step[0]
    # what MATLAB keeps one of is a matrix of one
    while value.dtype == object and value.size == 1:
        value = np.asarray(value.reshape(-1)[0])
    if value.dtype.kind not in "iufb":
        hint = ""
        if isinstance(content[root], np.void) or "MatlabOpaque" in type(content[root]).__name__:
            hint = f"; write an object such as a timeseries as numbers: t = {root}.Time; x = {root}.Data; save(FILE, 't', 'x')"
        held = f"a struct with {', '.join(value.dtype.names)}" if value.dtype.names else "no real numbers"
        raise UsageError(f"{source}: '{name}' holds {held}{hint}")
    check_one_column(source, name, value, ("(", ")"), "1")
    return value.reshape(-1).astype(np.float64)


def _field(value: np.ndarray, name: str, where: str) -> np.ndarray:
    """Return a field of a structure, or all of them of an array of structures, where each holds one number."""
    while value.dtype == object and value.size == 1:
        value = np.asarray(value.reshape(-1)[0])
    names = value.dtype.names or ()
    if name not in names:
        raise unknown("field", name, names, where)
    found = [np.asarray(one[name]) for one in value.reshape(-1)]
    if len(found) == 1:
        return found[0]
    if all(one.size == 1 and one.dtype.kind in "iufb" for one in found):
        return np.array([one.reshape(-1)[0] for one in found])
    example = where.split("'")[1]
    raise UsageError(f"{where} is an array of {len(found)} structures: say which, {example}(1).{name}")


def _part(value: np.ndarray, said: str, name: str, of: str, source: Path) -> np.ndarray:
    """Return what an index in MATLAB's way, counted from 1, takes of an array."""
    parts = [part.strip() for part in said.split(",")]
    shape = " x ".join(map(str, value.shape))
    # one number counts through the columns
    array = value.reshape(-1, order="F") if len(parts) == 1 else value
    allowed = len(parts) == array.ndim and all(
        part == ":" or (part.isdigit() and 1 <= int(part) <= size) for part, size in zip(parts, array.shape, strict=True)
    )
    if not allowed:
        raise UsageError(f"{source}: {name} is not there; the size of {of} is {shape}")
    return np.asarray(array[tuple(slice(None) if part == ":" else int(part) - 1 for part in parts)])


def names_within(content: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of all columns of numbers of more than one value in variables, as ``column_named`` reads them."""
    for name, value in content.items():
        yield from _within(np.asarray(value), name, 0)


def _within(value: np.ndarray, name: str, depth: int) -> Iterator[str]:
    if depth > DEEPEST:
        return
    if value.dtype.names:
        many = value.size > 1
        for place, one in enumerate(value.reshape(-1)[:MOST_WITHIN]):
            for field in value.dtype.names:
                yield from _within(
                    np.asarray(one[field]), f"{name}({place + 1}).{field}" if many else f"{name}.{field}", depth + 1
                )
    elif value.dtype == object:
        many = value.size > 1
        for place, one in enumerate(value.reshape(-1, order="F")[:MOST_WITHIN]):
            yield from _within(np.asarray(one), f"{name}{{{place + 1}}}" if many else name, depth + 1)
    elif value.dtype.kind in "iufb" and value.size > 1:
        if value.size == max(value.shape):
            yield name
        elif value.ndim == 2 and min(value.shape) <= MOST_WITHIN:
            along = int(np.argmax(value.shape))
            yield from (f"{name}(:,{k + 1})" if along == 0 else f"{name}({k + 1},:)" for k in range(value.shape[1 - along]))
