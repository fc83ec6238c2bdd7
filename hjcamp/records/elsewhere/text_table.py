"""How a table of text is written where nobody says so: its separator, its header, and whether it has a decimal comma."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

SEPARATORS = (";", "\t", "|", ",")
BLANKS = " "
EMPTY = "".join(SEPARATORS) + ' "\t\r\n'
REMARKS = ("#", "%")
LOOKED_AT = 1000  # lines


@dataclass(frozen=True)
class Dialect:
    """How a table of text is written; ``comment``: with what the lines begin that are no rows. A space stands for any blanks.

    Columns without a ``header`` are called 1, 2, 3, ...
    """

    separator: str = ","
    decimal_comma: bool = False
    comment: str | None = None
    header: bool = True


def table_of(lines: Sequence[str], names: Collection[str], comment: str | None = None) -> list[str]:
    """Return the lines of a table: without empty ones, rows without any value at its end, and a separator at rows' ends.

    What is before the header with all ``names`` is no part of it.
    """
    first = 0
    if not all(name.isdigit() for name in names):
        headers = (k for k, line in enumerate(lines[:LOOKED_AT]) if any(_has(line, names, one) for one in (*SEPARATORS, BLANKS)))
        first = next(headers, 0)
    kept = [line for line in lines[first:] if line.strip()]
    while len(kept) > 1 and not kept[-1].strip(EMPTY):
        kept.pop()
    rows = [line for line in kept if not (comment and line.startswith(comment))][1:]
    for one in SEPARATORS:
        # the last row may be cut off
        if len(rows) > 1 and not kept[0].endswith(one) and all(row.endswith(one) for row in rows[:-1]):
            return [kept[0], *(row.removesuffix(one) for row in kept[1:])]
    return kept


def dialect_of(lines: Sequence[str], comment: str | None = None) -> Dialect:
    """Return how a table is written, by its header and its first rows.

    A separator stands equally often in each of them; a decimal comma needs another one. Lines before the header that begin
    with # or % are remarks where they do not look like rows.
    """
    rows = _rows(lines, comment)
    if comment is None and rows and rows[0].startswith(REMARKS) and not _separator(rows):
        comment = rows[0][0]
        rows = _rows(lines, comment)
    found = _separator(rows) or ","
    cells = [cell for row in rows[1:] for cell in _cells(row, found)]
    # dates have points as well
    has_comma = found != "," and any(_has_comma(cell) for cell in cells) and not any("." in cell and _is_number(cell) for cell in cells)
    kinds = [[_is_number(cell.replace(",", ".") if has_comma else cell) for cell in _cells(row, found)] for row in rows[:2]]
    # what is a number in the second row is a name in a header
    header = not kinds or not any(kinds[-1]) or kinds[0] != kinds[-1]
    return Dialect(found, has_comma, comment, header)


def _has(line: str, names: Collection[str], separator: str) -> bool:
    return set(names) <= {cell.strip().strip('"') for cell in _cells(line, separator)}


def _rows(lines: Iterable[str], comment: str | None) -> list[str]:
    return [line for line in lines if line.strip() and not (comment and line.startswith(comment))][:5]


def _separator(rows: list[str]) -> str:
    return next((one for one in (*SEPARATORS, BLANKS) if _alike(rows, one)), "")


def _alike(rows: Iterable[str], separator: str) -> bool:
    counts = {len(_cells(row, separator)) for row in rows}
    return len(counts) == 1 and max(counts) > 1


def _cells(row: str, separator: str) -> list[str]:
    return row.split() if separator == BLANKS else row.split(separator)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _has_comma(cell: str) -> bool:
    whole, comma, part = cell.strip().lstrip("+-").partition(",")
    return bool(comma) and whole.isdigit() and part[:1].isdigit()
