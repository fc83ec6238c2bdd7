"""Read the columns that an import needs from the file of another program: CSV, MATLAB, Parquet, MCAP."""

from __future__ import annotations

import io
import math
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.map_values import GAPS_HINT
from hjcamp.records.elsewhere.text_table import BLANKS, dialect_of, most_cells, table_of, with_whole_quotes
from hjcamp.records.elsewhere.written_times import seconds_of, time_of_day

if TYPE_CHECKING:
    import polars

LOOKED_AT = 4096
MOST_COLUMNS = 20_000
# A value within what a row holds: pose.x, position[0].
WITHIN = re.compile(r"\.?(?P<name>[^.[]+)|\[(?P<at>\d+)\]")
# What is on or off, as programs write it.
SWITCHED = {"true": 1.0, "false": 0.0, "on": 1.0, "off": 0.0}
NS_IN = {"ns": 1.0, "us": 1e3, "ms": 1e6}


@dataclass(frozen=True)
class Table:
    """The columns asked for, each of shape (rows,), the times of the rows, s (None: not known), and what to say of them."""

    columns: dict[str, np.ndarray]
    times: np.ndarray | None = None
    notes: tuple[str, ...] = ()


def read_table(source: Path, rules: ImportMap) -> Table:
    """Return the columns of a file that the map names; the end of its name says what it is.

    Raises UsageError for a file that cannot be read, a column that is not there, and a value that is no number.
    """
    names = list(dict.fromkeys(rule.key for rule in rules.rules.values()))
    reader = READERS.get(source.suffix.casefold(), _read_csv)
    try:
        if not source.is_file():
            raise UsageError(f"{source}: cannot be read: {'it is a folder' if source.is_dir() else 'No such file'}")
        found = reader(source, names, rules)
    except OSError as error:
        raise UsageError(f"{source}: cannot be read: {error.strerror or error}") from error
    lengths = {name: len(values) for name, values in found.columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise UsageError(f"{source}: the columns are not equally long: {listed}")
    if numbers := [one for one in rules.missing if not isinstance(one, str)]:
        for name, values in found.columns.items():
            found.columns[name] = np.where(np.isin(values, numbers), np.nan, values)
    return found


def _read_csv(source: Path, names: list[str], rules: ImportMap) -> Table:
    import polars

    with source.open("rb") as stream:
        if b"\0" in stream.read(LOOKED_AT):
            listed = ", ".join(READERS)
            raise UsageError(f"{source}: this is no table of text in UTF-8; those, {listed} can be read")
    lines = _text_of(source).split("\n")[rules.skip_lines :]
    # a line of so few characters has no more cells
    _check_width(source, max((most_cells(line) for line in lines if len(line) > MOST_COLUMNS), default=0))
    lines = table_of(lines, names, rules.comment)
    try:
        found = dialect_of(lines, rules.comment, rules.separator, rules.header)
    except UsageError as fault:
        raise UsageError(f"{source}: {fault}") from None
    separator = found.separator
    if separator == BLANKS:
        lines, separator = ["\t".join(line.split()) for line in lines], "\t"
    if found.row_names:
        lines = [f"{separator}{lines[0]}", *lines[1:]]
    lines = with_whole_quotes(lines, separator)
    comma = rules.decimal_comma if rules.decimal_comma is not None else found.decimal_comma
    try:
        table = polars.read_csv(
            io.BytesIO("".join(f"{line}\n" for line in lines).encode()),
            has_header=found.header,
            separator=separator,
            comment_prefix=found.comment,
            encoding="utf8-lossy",
            infer_schema=False,
        )
    except polars.exceptions.PolarsError as error:
        raise UsageError(
            f"{source}: cannot be read as a table with {separator!r} between its columns: {_first_line(error)}; the map may say "
            "separator, decimal_comma, header, skip_lines (before the header) and comment"
        ) from error
    table.columns = [name.replace('""', '"') if found.header else str(place + 1) for place, name in enumerate(table.columns)]
    return Table(_numbers(source, table, names, comma, rules))


def _check_width(source: Path, columns: int) -> None:
    """Raise ``UsageError`` for a table of more columns than anybody measures."""
    if columns > MOST_COLUMNS:
        raise UsageError(
            f"{source}: {columns} columns; a table has at most {MOST_COLUMNS} (does each row stand on a line of its own?)"
        )


def _text_of(source: Path) -> str:
    """Return a table's text: UTF-8, else as Windows writes it (cp1252), where the degree sign is one byte."""
    content = source.read_bytes()
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _read_parquet(source: Path, names: list[str], rules: ImportMap) -> Table:
    import polars

    try:
        with _quiet():
            _check_width(source, len(polars.read_parquet_schema(source)))
            table = polars.read_parquet(source, use_pyarrow=False)
    except (polars.exceptions.PolarsError, polars.exceptions.PanicException, ValueError) as error:
        raise UsageError(f"{source}: cannot be read as Parquet: {_first_line(error)}") from error
    return Table(_numbers(source, table, names, False, rules))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep away what polars' own threads print of damaged bytes; the error that follows is told in one line."""
    sys.stderr.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _numbers(
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


def _read_mat(source: Path, names: list[str], rules: ImportMap) -> Table:
    from hjcamp.records.elsewhere.mat_table import read_mat

    return Table(read_mat(source, names))


def _read_mcap(source: Path, names: list[str], rules: ImportMap) -> Table:
    from hjcamp.records.elsewhere.foreign_mcap import read_messages

    return Table(*read_messages(source, rules))


def _first_line(error: BaseException) -> str:
    return next(iter(str(error).strip().splitlines()), "") or type(error).__name__


READERS: dict[str, Callable[[Path, list[str], ImportMap], Table]] = {
    ".parquet": _read_parquet,
    ".pq": _read_parquet,
    ".mat": _read_mat,
    ".mcap": _read_mcap,
}
