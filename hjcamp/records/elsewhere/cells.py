"""The cells of a table as numbers, whatever wrote them: texts, dates, times, switches, values within structures."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.map_values import GAPS_HINT
from hjcamp.records.elsewhere.written_times import seconds_of, time_of_day

if TYPE_CHECKING:
    import polars

# A value within what a row holds: pose.x, position[0].
WITHIN = re.compile(r"\.?(?P<name>[^.[]+)|\[(?P<at>\d+)\]")
# What is on or off, as programs write it.
SWITCHED = {"true": 1.0, "false": 0.0, "on": 1.0, "off": 0.0}
NS_IN = {"ns": 1.0, "us": 1e3, "ms": 1e6}


def numbers_of(
    source: Path, table: polars.DataFrame, names: list[str], decimal_comma: bool, rules: ImportMap
) -> dict[str, np.ndarray]:
    """Return columns as numbers; a cell that is empty or ``missing`` is no number, or refused where gaps are not filled."""
    import polars

    if len({name.strip() for name in table.columns}) == len(table.columns):
        table = table.rename({name: name.strip() for name in table.columns})
    columns: dict[str, np.ndarray] = {}
    for name in names:
        column = _column(source, table, name)
        if column.dtype == polars.String:
            column = column.str.strip_chars()
            column = column.set(column.is_in([one for one in rules.missing if isinstance(one, str)]), None)
            numbers = _of_text(source, name, column, decimal_comma)
        elif isinstance(column.dtype, polars.Datetime | polars.Duration):
            ticks = column.cast(polars.Int64)
            numbers = (ticks - (ticks.min() or 0)) * (NS_IN[column.dtype.time_unit or "us"] * 1e-9)
        elif column.dtype == polars.Time:
            numbers = column.cast(polars.Int64).cast(polars.Float64)
            if not column.null_count():
                numbers = polars.Series(time_of_day(column.cast(polars.Int64).to_numpy()))
        elif column.dtype.is_numeric() or column.dtype == polars.Boolean:
            numbers = column.cast(polars.Float64)
        else:
            inner = f"; name what is within it: {name}.NAME" if isinstance(column.dtype, polars.Struct) else ""
            inner = f"; name one of its values: {name}[0]" if isinstance(column.dtype, polars.List | polars.Array) else inner
            raise UsageError(f"{source}: '{name}' holds {column.dtype.base_type()}, not numbers{inner}")
        empty = column.is_null() | (column == "") if column.dtype == polars.String else column.is_null()
        if rules.interpolate:
            numbers = polars.select(polars.when(empty).then(math.nan).otherwise(numbers)).to_series()
        if numbers.null_count():
            raise _no_number(source, name, column, numbers, empty)
        columns[name] = numbers.to_numpy()
    return columns


def _column(source: Path, table: polars.DataFrame, name: str) -> polars.Series:
    """Return a column of a table, or what is within one: ``pose.x``, ``position[0]``."""
    import polars

    if f"{name}_duplicated_0" in table.columns:
        raise UsageError(f"{source}: several columns are called '{name}'; give each a name of its own")
    if name in table.columns:
        return table[name]
    steps = list(WITHIN.finditer(name))
    if not steps or steps[0][0] not in table.columns or "".join(step[0] for step in steps) != name:
        raise unknown("column", name, table.columns, str(source))
    column = table[steps[0][0]]
    for step in steps[1:]:
        if step["name"] and isinstance(column.dtype, polars.Struct):
            if step["name"] not in (known := [field.name for field in column.dtype.fields]):
                raise unknown("field", step["name"], known, f"'{steps[0][0]}' of {source}")
            column = column.struct.field(step["name"])
        elif step["at"] and isinstance(column.dtype, polars.List | polars.Array):
            column = column.cast(polars.List(column.dtype.inner)).list.get(int(step["at"]), null_on_oob=True)
        else:
            raise unknown("column", name, table.columns, str(source))
    return column


def _of_text(source: Path, name: str, column: polars.Series, decimal_comma: bool) -> polars.Series:
    """Return a column of texts as numbers, null where one is none; dates and times as seconds."""
    import polars

    text = column.str.replace(",", ".", literal=True) if decimal_comma else column
    numbers = text.cast(polars.Float64, strict=False)
    if numbers.null_count() == len(column):
        if column.str.to_lowercase().is_in([*SWITCHED]).all():
            return column.str.to_lowercase().replace_strict(SWITCHED, return_dtype=polars.Float64)
        seconds = seconds_of(column, f"{source}: '{name}'")
        return numbers if seconds is None else polars.Series(seconds)
    if decimal_comma and (pointed := column.str.contains(".", literal=True).fill_null(False)).any():
        row = int(pointed.arg_max() or 0)
        raise UsageError(
            f"{source}: '{name}' has a point in row {row + 1}, {column[row]!r:.60}, where the table has decimal commas; "
            "a mark for thousands cannot be read (decimal_comma: false in the map, where the points are decimal)"
        )
    return numbers


def _no_number(source: Path, name: str, column: polars.Series, numbers: polars.Series, empty: polars.Series) -> UsageError:
    """Return the error of a column with a cell that is no number, with the key of the map that helps."""
    import polars

    row = int(numbers.is_null().arg_max() or 0)
    below = column[1:].cast(polars.Float64, strict=False).null_count() if column.dtype == polars.String else row
    said = f"empty in row {row + 1}" if empty[row] else f"no number in row {row + 1}: {column[row]!r:.60}"
    hint = f"; {GAPS_HINT}" if empty[row] else ""
    if empty[row] and row == len(column) - 1:
        hint = ": it is the last, was it cut off? Delete it"
    elif row == 0 and len(column) > 1 and not below:
        hint = "; where units stand below the header, say in the map skip_lines: 2 and call the columns 1, 2, 3, ..."
    elif not empty[row] and "," in column[row]:
        hint = "; where commas are decimal, say in the map decimal_comma: true"
    elif not empty[row] and 2 * numbers.null_count() < len(column):
        hint = f"; where this stands for no reading, say in the map missing: [{column[row]!r:.60}]"
    return UsageError(f"{source}: '{name}' is {said}{hint}")
