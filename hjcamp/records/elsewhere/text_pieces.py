"""A large table of plain numbers, read in pieces: what stands in memory are the columns that a map names, and one piece."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.text_table import BLANKS, EMPTY, SEPARATORS, Dialect, cells_of, dialect_of, table_of

if TYPE_CHECKING:
    import polars

#: Bytes of a piece; a smaller file is read as a whole.
PIECE = 16 * 2**20
EMPTY_LINES = re.compile(rb"^[ \t]*\n", re.MULTILINE)


class _NotPlainError(Exception):
    """The table is to be read as a whole: it has quotes, dates, cells that are no numbers, or rows of several lengths."""


@dataclass(frozen=True)
class _Layout:
    """How each piece is read: its dialect, whether it has a decimal comma, and the place of each named column."""

    dialect: Dialect
    comma: bool
    places: dict[str, int]


def numbers_in_pieces(source: Path, names: Sequence[str], rules: ImportMap) -> dict[str, np.ndarray] | None:
    """Return the named columns, each (rows,), of a table of plain numbers; None for one that has to be read as a whole."""
    if source.stat().st_size <= PIECE:
        return None
    found: dict[str, list[np.ndarray]] = {name: [] for name in names}
    try:
        with source.open("rb") as stream:
            pieces = _pieces(stream)
            layout, first = _begun(next(pieces), names, rules)
            for piece in _without_empty_end(first, pieces):
                for name, values in _numbers(piece, layout, rules).items():
                    found[name].append(values)
    except (_NotPlainError, UsageError):
        return None
    return {name: np.concatenate(found.pop(name)) for name in names}


def _without_empty_end(first: bytes, rest: Iterator[bytes]) -> Iterator[bytes]:
    """Yield the pieces; rows without any value at the end of the table are left out."""
    before = first
    for piece in rest:
        yield before
        before = piece
    lines = before.decode("latin-1").splitlines()
    while lines and not lines[-1].strip(EMPTY):
        lines.pop()
    yield "".join(f"{line}\n" for line in lines).encode("latin-1")


def _pieces(stream: BinaryIO) -> Iterator[bytes]:
    """Yield the lines of a file in pieces of whole lines, each line with one line feed."""
    rest = b""
    while read := stream.read(PIECE):
        end = read.rfind(b"\n") + 1
        if not end:
            raise _NotPlainError
        yield _lines(rest + read[:end])
        rest = read[end:]
    if rest:
        yield _lines(rest + b"\n")


def _lines(piece: bytes) -> bytes:
    if b'"' in piece or b"\0" in piece:
        raise _NotPlainError
    return piece.replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _begun(piece: bytes, names: Sequence[str], rules: ImportMap) -> tuple[_Layout, bytes]:
    """Return how a table is written, by its first piece, and the rows of that piece."""
    try:
        text = piece.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = piece.decode("cp1252", "replace")
    lines = text.split("\n")[rules.skip_lines :]
    kept = table_of(lines, names, rules.comment)
    if rules.units_below:
        del kept[1:2]
    if len(kept) < 2 or any(line.endswith(SEPARATORS) for line in lines[-3:]):
        raise _NotPlainError
    found = dialect_of(kept, rules.comment, rules.separator, rules.header)
    if found.row_names:
        raise _NotPlainError
    rows = [line for line in kept if not (found.comment and line.startswith(found.comment))]
    head = [cell.strip() for cell in cells_of(rows[0], found.separator)]
    known = head if found.header else [str(k + 1) for k in range(len(head))]
    if len(set(known)) < len(known) or not set(names) <= set(known):
        raise _NotPlainError
    comma = rules.decimal_comma if rules.decimal_comma is not None else found.decimal_comma
    layout = _Layout(found, comma, {name: known.index(name) for name in names})
    return layout, "".join(f"{line}\n" for line in rows[found.header :]).encode()


def _numbers(piece: bytes, layout: _Layout, rules: ImportMap) -> dict[str, np.ndarray]:
    """Return the named columns of the rows of a piece."""
    import polars

    separator, piece = layout.dialect.separator, EMPTY_LINES.sub(b"", piece)
    if separator == BLANKS:
        piece, separator = b"".join(b"\t".join(line.split()) + b"\n" for line in piece.splitlines()), "\t"
    if not piece:
        return {}
    try:
        table = polars.read_csv(
            io.BytesIO(piece),
            has_header=False,
            separator=separator,
            comment_prefix=layout.dialect.comment,
            quote_char=None,
            encoding="utf8-lossy",
            infer_schema=False,
        )
    except polars.exceptions.PolarsError as error:
        raise _NotPlainError from error
    if table.width <= max(layout.places.values()):
        raise _NotPlainError
    return {name: _plain(table.to_series(place), layout.comma, rules) for name, place in layout.places.items()}


def _plain(column: polars.Series, comma: bool, rules: ImportMap) -> np.ndarray:
    """Return a column of texts as numbers; what is empty or stands for no reading is none where gaps are filled."""
    import polars

    column = column.str.strip_chars()
    column = column.set(column.is_in([one for one in rules.missing if isinstance(one, str)]), None)
    if comma and column.str.contains(".", literal=True).any():
        raise _NotPlainError
    numbers = (column.str.replace(",", ".", literal=True) if comma else column).cast(polars.Float64, strict=False)
    empty = column.is_null() | (column == "")
    if int(numbers.null_count()) > int(empty.sum()) or (not rules.interpolate and numbers.null_count()):
        raise _NotPlainError
    return numbers.fill_null(math.nan).to_numpy()
