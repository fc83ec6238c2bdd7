"""Read the columns that an import needs from the file of another program: CSV, MATLAB, Parquet, MCAP."""

from __future__ import annotations

import io
import math
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.text_table import BLANKS, dialect_of, table_of

if TYPE_CHECKING:
    import polars

# MATLAB's own way to name a column of a matrix: q(:,2).
MATRIX_COLUMN = re.compile(r"(?P<name>.+)\(:,\s*(?P<column>\d+)\)")
LOOKED_AT = 4096
# Stands before times of a day without a date.
ANY_DAY = "2000-01-01 "
# Dates that no standard writes, the month before the day or behind it: of those that can be read the shortest test.
DATES = ("%m/%d/%Y %I:%M:%S%.f %p", "%m/%d/%Y %H:%M:%S%.f", "%d/%m/%Y %H:%M:%S%.f", "%d/%m/%Y %I:%M:%S%.f %p")
# What is on or off, as programs write it.
GAPS = "gaps: interpolate in the map draws lines between its neighbours"
SWITCHED = {"true": 1.0, "false": 0.0, "on": 1.0, "off": 0.0}
NS_IN = {"ns": 1.0, "us": 1e3, "ms": 1e6}


@dataclass(frozen=True)
class Table:
    """The columns asked for, each of shape (rows,), and what the rows say of their times, s (None: nothing)."""

    columns: dict[str, np.ndarray]
    times: np.ndarray | None = None


def read_table(source: Path, rules: ImportMap) -> Table:
    """Return the columns of a file that the map names; the end of its name says what it is.

    Raises UsageError for a file that cannot be read, a column that is not there, and a value that is no number.
    """
    names = list(dict.fromkeys(rule.column for rule in rules.rules.values()))
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
    return found


def _read_csv(source: Path, names: list[str], rules: ImportMap) -> Table:
    import polars

    with source.open("rb") as stream:
        if b"\0" in stream.read(LOOKED_AT):
            listed = ", ".join(READERS)
            raise UsageError(f"{source}: this is no table of text in UTF-8; those, {listed} can be read")
    lines = table_of(_text_of(source).split("\n")[rules.skip_lines :], names, rules.comment)
    found = dialect_of(lines, rules.comment)
    separator = rules.separator or found.separator
    if separator == BLANKS:
        lines, separator = ["\t".join(line.split()) for line in lines], "\t"
    comma = rules.decimal_comma if rules.decimal_comma is not None else found.decimal_comma and separator != ","
    try:
        table = polars.read_csv(
            io.BytesIO("".join(f"{line}\n" for line in lines).encode()),
            has_header=found.header,
            separator=separator,
            decimal_comma=comma,
            comment_prefix=found.comment,
            encoding="utf8-lossy",
            infer_schema=False,
        )
    except polars.exceptions.PolarsError as error:
        raise UsageError(
            f"{source}: cannot be read as a table with {separator!r} between its columns: {_first_line(error)}; the map may say "
            "separator, decimal_comma, skip_lines (before the header) and comment"
        ) from error
    if not found.header:
        table.columns = [str(place + 1) for place in range(table.width)]
    return Table(_numbers(source, table, names, comma, rules.interpolate))


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
            table = polars.read_parquet(source, use_pyarrow=False)
    except (polars.exceptions.PolarsError, polars.exceptions.PanicException, ValueError) as error:
        raise UsageError(f"{source}: cannot be read as Parquet: {_first_line(error)}") from error
    return Table(_numbers(source, table, names, False, rules.interpolate))


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
    source: Path, table: polars.DataFrame, names: list[str], decimal_comma: bool, gaps: bool
) -> dict[str, np.ndarray]:
    """Return columns as numbers; an empty cell is no number, or refused where there may be no ``gaps``."""
    import polars

    if len({name.strip() for name in table.columns}) == len(table.columns):
        table = table.rename({name: name.strip() for name in table.columns})
    columns: dict[str, np.ndarray] = {}
    for name in names:
        if f"{name}_duplicated_0" in table.columns:
            raise UsageError(f"{source}: several columns are called '{name}'; give each a name of its own")
        if name not in table.columns:
            raise unknown("column", name, table.columns, str(source))
        column = table[name]
        if column.dtype == polars.String:
            column = column.str.strip_chars()
            text = column.str.replace(",", ".", literal=True) if decimal_comma else column
            numbers = text.cast(polars.Float64, strict=False)
            if numbers.null_count() == len(column):
                numbers = _switched(column) if column.str.to_lowercase().is_in([*SWITCHED]).all() else _seconds(column, numbers)
            elif decimal_comma and (pointed := column.str.contains(".", literal=True).fill_null(False)).any():
                row = int(pointed.arg_max() or 0)
                raise UsageError(
                    f"{source}: '{name}' has a point in row {row + 1}, {column[row]!r:.60}, where the table has decimal commas; "
                    "a mark for thousands cannot be read (decimal_comma: false in the map, where the points are decimal)"
                )
        elif isinstance(column.dtype, polars.Datetime | polars.Duration):
            ticks = column.cast(polars.Int64)
            numbers = (ticks - (ticks.min() or 0)) * (NS_IN[column.dtype.time_unit or "us"] * 1e-9)
        elif column.dtype.is_numeric() or column.dtype == polars.Boolean:
            numbers = column.cast(polars.Float64)
        else:
            raise UsageError(f"{source}: '{name}' holds {column.dtype}, not numbers")
        empty = column.is_null() | (column == "") if column.dtype == polars.String else column.is_null()
        if gaps:
            numbers = polars.select(polars.when(empty).then(math.nan).otherwise(numbers)).to_series()
        if numbers.null_count():
            row = int(numbers.is_null().arg_max() or 0)
            said = f"empty in row {row + 1}" if empty[row] else f"no number in row {row + 1}: {column[row]!r:.60}"
            below = column[1:].cast(polars.Float64, strict=False).null_count() if column.dtype == polars.String else row
            hint = f"; {GAPS}" if empty[row] else ""
            if empty[row] and row == len(column) - 1:
                hint = ": it is the last, was it cut off? Delete it"
            if row == 0 and len(column) > 1 and not below:
                hint = "; where units stand below the header, say in the map skip_lines: 2 and call the columns 1, 2, 3, ..."
            raise UsageError(f"{source}: '{name}' is {said}{hint}")
        columns[name] = numbers.to_numpy()
    return columns


def _switched(column: polars.Series) -> polars.Series:
    """Return what was on as 1 and what was off as 0."""
    import polars

    return column.str.to_lowercase().replace_strict(SWITCHED, return_dtype=polars.Float64)


def _seconds(column: polars.Series, otherwise: polars.Series) -> polars.Series:
    """Return dates and times written out (2026-01-31 12:00:00.5, 12:00:00.5, 1/31/2026 12:00:00 PM) as seconds since the first.

    Else return what is said ``otherwise``; a time that never goes on, too, may be refused.
    """
    import polars

    seconds = []
    for day, form in (("", None), (ANY_DAY, None), *(("", form) for form in DATES)):
        try:
            found = (day + column).str.to_datetime(form, time_unit="ns", strict=False)
        except polars.exceptions.PolarsError:
            continue
        if not found.null_count():
            ticks = found.cast(polars.Int64)
            seconds.append((ticks - (ticks.min() or 0)) * 1e-9)
    going = [one for one in seconds if (one.diff().drop_nulls() > 0.0).all()] or seconds[:1]
    return min(going, key=lambda one: one[-1], default=otherwise)


def _read_mat(source: Path, names: list[str], rules: ImportMap) -> Table:
    from scipy.io import loadmat, whosmat

    wanted = sorted({re.split(r"[.(]", name)[0] for name in names})
    try:
        with warnings.catch_warnings(action="ignore"):
            variables = [name for name, _, _ in whosmat(source)]
            content = loadmat(source, squeeze_me=False, variable_names=wanted)
    except NotImplementedError as error:
        raise UsageError(
            f"{source}: this is a file of MATLAB 7.3 (HDF5), which cannot be read; in MATLAB write it again: "
            f"save('{source.stem}.mat', '-v7')"
        ) from error
    except OSError:
        raise
    except Exception as error:  # scipy raises many kinds for bytes that are no such file
        raise UsageError(f"{source}: cannot be read as a MATLAB file: {_first_line(error)}") from error
    return Table({name: _of_mat(source, name, content, variables) for name in names})


def _of_mat(source: Path, name: str, content: dict[str, Any], variables: list[str]) -> np.ndarray:
    """Return one variable, a field of a struct (``data.q``), or a column of a matrix (``q(:,2)``) as numbers."""
    match = MATRIX_COLUMN.fullmatch(name)
    root, *parts = (match["name"] if match else name).split(".")
    if root not in content:
        raise unknown("variable", root, variables, str(source))
    value = content[root]
    for depth, part in enumerate(parts):
        within = ".".join([root, *parts[:depth]])
        fields = getattr(value, "dtype", np.dtype(float)).names or ()
        if part not in fields or np.size(value) != 1:
            raise unknown("field", part, fields, f"'{within}' of {source}")
        value = np.asarray(value).reshape(-1)[0][part]
    value = np.asarray(value)
    if value.dtype.kind not in "iufb":
        held = f"a struct with {', '.join(value.dtype.names)}" if value.dtype.names else "no real numbers"
        raise UsageError(f"{source}: '{name}' holds {held}")
    if match is not None:
        number = int(match["column"])
        if value.ndim != 2 or not 1 <= number <= value.shape[1]:
            raise UsageError(f"{source}: '{name}' is not there; the size of '{match['name']}' is {_size(value)}")
        value = value[:, number - 1]
    elif value.ndim > 2 or (value.ndim == 2 and min(value.shape) > 1):
        raise UsageError(f"{source}: '{name}' is a matrix ({_size(value)}); give one column of it: {name}(:,1)")
    return value.reshape(-1).astype(np.float64)


def _size(value: np.ndarray) -> str:
    return " x ".join(map(str, value.shape))


def _read_mcap(source: Path, names: list[str], rules: ImportMap) -> Table:
    from hjcamp.records.elsewhere.foreign_mcap import read_messages

    columns, times = read_messages(source, names, rules.topic, rules.where)
    return Table(columns, times)


def _first_line(error: BaseException) -> str:
    return next(iter(str(error).strip().splitlines()), "") or type(error).__name__


READERS: dict[str, Callable[[Path, list[str], ImportMap], Table]] = {
    ".parquet": _read_parquet,
    ".pq": _read_parquet,
    ".mat": _read_mat,
    ".mcap": _read_mcap,
}
