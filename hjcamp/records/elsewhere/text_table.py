"""How a table of text is written where nobody says so: its separator, its header, and whether it has a decimal comma."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

SEPARATORS = (";", "\t", "|", ",")
BLANKS = " "
REMARKS = ("#", "%")
LOOKED_AT = 64 * 1024


@dataclass(frozen=True)
class Dialect:
    """How a table of text is written; ``comment``: with what the lines begin that are no rows. A space stands for any blanks.

    Columns without a ``header`` are called 1, 2, 3, ...
    """

    separator: str = ","
    decimal_comma: bool = False
    comment: str | None = None
    header: bool = True


def dialect_of(source: Path, skip_lines: int = 0, comment: str | None = None) -> Dialect:
    """Return how a file is written, by its header and its first rows.

    A separator stands equally often in each of them; a decimal comma needs another one. Lines before the header that begin
    with # or % are remarks where they do not look like rows. Raises ``OSError`` for a file that cannot be read.
    """
    with source.open("rb") as stream:
        lines = stream.read(LOOKED_AT).decode("utf-8-sig", "replace").splitlines()[skip_lines:]
    rows = _rows(lines, comment)
    if comment is None and rows and rows[0].startswith(REMARKS) and not _separator(rows):
        comment = rows[0][0]
        rows = _rows(lines, comment)
    found = _separator(rows) or ","
    cells = [cell for row in rows[1:] for cell in _cells(row, found)]
    has_comma = found != "," and any(_has_comma(cell) for cell in cells) and not any("." in cell for cell in cells)
    kinds = [[_is_number(cell.replace(",", ".") if has_comma else cell) for cell in _cells(row, found)] for row in rows[:2]]
    # what is a number in the second row is a name in a header
    header = not kinds or not any(kinds[-1]) or kinds[0] != kinds[-1]
    return Dialect(found, has_comma, comment, header)


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
