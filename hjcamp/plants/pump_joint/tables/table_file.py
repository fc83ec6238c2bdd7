"""A user's own table of indicators: a CSV file with declared columns."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, nearest, shown, unknown
from hjcamp.plants.pump_joint.tables.cells import SIMULATED, Cells
from hjcamp.report.runs.indicators import INDICATORS

DEVIATION = "_deviation"
TESTS = "tests"
#: What the columns of a run's own tables are called here, and those that compare with something else: passed over.
OWN = {"n": TESTS}
for _name in INDICATORS:
    OWN |= {f"{_name}_mean": _name, f"{_name}_std": f"{_name}{DEVIATION}"}
REFERENCE_COLUMNS = re.compile(rf"({'|'.join(INDICATORS)})_(published|baseline|difference|arrow|p)(_.*)?|published_differs")


def read_table(path: Path) -> Cells:
    """Return the cells of a CSV file.

    Columns: what names a condition (``trajectory``, ``controller``, ``payload`` ..., or a parameter such as
    ``controller.scale``), ``tests`` (repetitions behind each mean, 2 or more), then for each indicator its mean and its
    sample deviation, in degrees: ``rmse1_deg``, ``rmse1_deg_deviation``. A mean and its deviation may both be left empty
    where nothing was measured. A run's own table is read too, by the names that it has for them (`OWN`). Raises
    ``UsageError`` for anything else, with line and column.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            reader = csv.reader(stream)
            numbered = [(reader.line_num, [cell.strip() for cell in line]) for line in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"table {path}: cannot be read ({error})") from error
    numbered = [(number, line) for number, line in numbered if any(line)]
    lines = [line for _, line in numbered]
    if lines and len(lines[0]) == 1 and ";" in lines[0][0]:
        raise UsageError(f"table {path}: its cells are parted by semicolons; part them by commas, with points in numbers")
    if len(lines) < 2:
        raise UsageError(f"table {path}: it needs a line of column names and one line for each condition")
    (_, header), *body = numbered
    header = [OWN.get(name, name) for name in header]
    keys, indicators = _columns(path, [name for name in header if not REFERENCE_COLUMNS.fullmatch(name)])
    conditions: list[dict[str, str]] = []
    found: list[tuple[int, int, float, float, float]] = []
    for number, line in body:
        where = f"table {path}, line {number}"
        if len(line) != len(header):
            raise UsageError(f"{where}: {len(line)} cells, but the first line names {len(header)} columns")
        row = dict(zip(header, line, strict=True))
        place = {key: row[key] for key in keys}
        for key, value in place.items():
            if not value:
                raise UsageError(f"{where}, column {key}: empty; every condition is named in full")
        if place in conditions:
            raise UsageError(f"{where}: the condition {' '.join(place.values())} stands in an earlier line already")
        conditions.append(place)
        found += [(len(conditions) - 1, *cell) for cell in _cells(where, row, indicators)]
    if not found:
        raise UsageError(f"table {path}: every mean is empty")
    rows, columns, *values = zip(*found, strict=True)
    means, errors, simulated = map(np.array, values)
    return Cells((path.name,) * len(found), conditions, np.array(rows), np.array(columns), means, errors, 0.0, simulated)


def _columns(path: Path, header: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the columns that name a condition, and the indicators."""
    if doubled := [name for name in header if header.count(name) > 1]:
        raise UsageError(f"table {path}: column {shown(doubled[0])} stands there twice")
    indicators = [name for name in header if name in INDICATORS]
    for name in header:
        stem, _, unit = name.removesuffix(DEVIATION).rpartition("_")
        if f"{stem}_deg" in INDICATORS and unit != "deg":
            raise UsageError(f"table {path}, column {name}: its unit is {unit}; give degrees, as {stem}_deg")
    if not indicators:
        raise unknown("indicator", next((n for n in header if "_" in n), header[-1]), INDICATORS, f"table {path}")
    for name in indicators:
        if f"{name}{DEVIATION}" not in header:
            raise UsageError(
                f"table {path}: {name} has no column {name}{DEVIATION}; without the deviation of its tests no mean can be judged"
            )
    if TESTS not in header:
        raise UsageError(f"table {path}: column {TESTS} is missing: how many tests stand behind each mean")
    own = {TESTS, *indicators, *(f"{name}{DEVIATION}" for name in indicators)}
    keys = [name for name in header if name not in own]
    for name in keys:
        if name.endswith((DEVIATION, "_deg")):
            raise unknown("indicator", name.removesuffix(DEVIATION), INDICATORS, f"table {path}")
    if not keys:
        raise UsageError(f"table {path}: no column names a condition, such as trajectory or controller")
    return keys, indicators


def _cells(where: str, row: Mapping[str, str], indicators: Sequence[str]) -> list[tuple[int, float, float, float]]:
    """Return column, mean, error of the mean and of as many simulated tests of each indicator of a row."""
    tests = _number(where, TESTS, row[TESTS])
    if tests < 2 or tests != int(tests):
        raise UsageError(f"{where}, column {TESTS}: {row[TESTS]}; give a whole number, 2 or more")
    found = []
    for name in indicators:
        mean, deviation = row[name], row[f"{name}{DEVIATION}"]
        if not mean and not deviation:
            continue
        if not mean or not deviation:
            missing = name if not mean else f"{name}{DEVIATION}"
            raise UsageError(f"{where}, column {missing}: empty; give mean and deviation, or leave both empty")
        value, spread = _number(where, name, mean), _number(where, f"{name}{DEVIATION}", deviation)
        if spread < 0 or (value <= 0 and name != "sse_deg"):
            raise UsageError(f"{where}, column {name}: {mean} with deviation {deviation}; neither can be so")
        found.append((INDICATORS.index(name), value, spread / math.sqrt(tests), spread / math.sqrt(SIMULATED)))
    _check_sizes(where, {INDICATORS[place]: value for place, value, *_ in found})
    return found


def _check_sizes(where: str, means: Mapping[str, float]) -> None:
    """Refuse a mean that is above the largest error of the same tests: most often another unit."""
    largest = means.get("e_max_deg", math.inf)
    for name, value in means.items():
        if abs(value) > largest:
            raise UsageError(
                f"{where}, column {name}: {value:g} is above the largest error, e_max_deg {largest:g}, which cannot be; "
                "are both in degrees?"
            )


def _number(where: str, column: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(f"{where}, column {column}: {shown(text)} is no number; what was not measured is left empty")
    return value


def matching(place: Mapping[str, str], conditions: Sequence[Any], where: str) -> Any:
    """Return the planned condition that a row names; ``UsageError`` for a row that the campaign does not have."""
    names = [{key: _value(one, key, where) for key in place} for one in conditions]
    for one, name in zip(conditions, names, strict=True):
        if name == dict(place):
            return one
    asked, known = " ".join(place.values()), [" ".join(map(str, name.values())) for name in names]
    match = nearest(asked, known)
    hint = f"; did you mean '{match}'?" if match else "."
    raise UsageError(f"{where}: the campaign has no condition '{asked}'{hint} Its conditions: {', '.join(known)}")


def _value(condition: Any, key: str, where: str) -> str:
    if key in condition.choices:
        return str(condition.choices[key])
    found: Any = condition.config
    for part in key.split("."):
        if not isinstance(found, Mapping) or part not in found:
            raise unknown("column", key, [*condition.choices, TESTS, *INDICATORS], where)
        found = found[part]
    return str(found)
