"""How a table of text is written where nobody says so: its separator, its header, and whether it has a decimal comma."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from hjcamp.errors import UsageError

SEPARATORS = (";", "\t", "|", ",")
BLANKS = " "
EMPTY = "".join(SEPARATORS) + ' "\t\r\n'
REMARKS = ("#", "%")
LOOKED_AT = 1000  # lines in which a header is looked for
JUDGED = 20_000  # rows by which a table is judged: all of a small one
MOST = 0.9  # of the rows have as many cells as the table has columns
DIGITS = re.compile(r"[+-]?\d+")
COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+")


@dataclass(frozen=True)
class Dialect:
    """How a table of text is written; ``comment``: with what the lines begin that are no rows. A space stands for any blanks.

    Columns without a ``header`` are called 1, 2, 3, ...; it may lack a name for the names of the rows (``row_names``).
    """

    separator: str = ","
    decimal_comma: bool = False
    comment: str | None = None
    header: bool = True
    row_names: bool = False


def table_of(lines: Sequence[str], names: Collection[str], comment: str | None = None) -> list[str]:
    """Return the lines of a table: without empty ones, rows without any value at its end, and a separator at rows' ends.

    What is before the header with all ``names`` is no part of it.
    """
    first = 0
    if not all(name.isdigit() for name in names):
        headers = (
            k for k, line in enumerate(lines[:LOOKED_AT]) if any(_has(line, names, one) for one in (*SEPARATORS, BLANKS))
        )
        first = next(headers, 0)
    kept = [line for line in lines[first:] if line.strip()]
    while len(kept) > 1 and (not kept[-1].strip(EMPTY) or _ends_it(kept)):
        kept.pop()
    rows = [line for line in kept if not (comment and line.startswith(comment))][1:]
    for one in SEPARATORS:
        # the last row may be cut off
        if len(rows) > 1 and not kept[0].endswith(one) and all(row.endswith(one) for row in rows[:-1]):
            return [kept[0], *(row.removesuffix(one) for row in kept[1:])]
    return kept


def dialect_of(
    lines: Sequence[str], comment: str | None = None, separator: str | None = None, header: bool | None = None
) -> Dialect:
    """Return how a table is written, by its header and its rows: all of them where it has at most 20 000.

    A separator gives nearly all rows as many cells, and the header no fewer, but for the names of the rows; a decimal
    comma needs another separator, or quotes. Lines before the header that begin with # or % are remarks where they do
    not look like rows. Raises UsageError for a first row of whole numbers that may be a header or not.
    """
    rows = _rows(lines, comment)
    if comment is None and rows and rows[0].startswith(REMARKS) and not _separator(rows[:5]):
        comment = rows[0][0]
        rows = _rows(lines, comment)
    found = separator or _separator(rows) or ","
    table = [cells_of(row, found) for row in rows]
    has_comma = _has_decimal_comma([cell for row in table[1:] for cell in row], found)
    has_header = header if header is not None else _has_header(table, has_comma)
    width = _width(table[1:])
    return Dialect(found, has_comma, comment, has_header, has_header and len(table) > 1 and 1 < len(table[0]) == width - 1)


def cells_of(row: str, separator: str) -> list[str]:
    """Return the cells of one row; a mark of inches is no quote."""
    if separator == BLANKS:
        return row.split()
    return next(csv.reader([row], delimiter=separator), []) if '"' in row else row.split(separator)


def most_cells(line: str) -> int:
    """Return how many cells a line has with the separator that divides it most."""
    return max(*(line.count(one) + 1 for one in SEPARATORS), len(line.split()))


def with_whole_quotes(lines: list[str], separator: str) -> list[str]:
    """Return the lines with every cell quoted as a reader of tables expects it, where a quote stands within a cell."""
    if not any('"' in cell and '""' not in line for line in lines if '"' in line for cell in cells_of(line, separator)):
        return lines
    return [separator.join('"' + cell.replace('"', '""') + '"' for cell in cells_of(line, separator)) for line in lines]


def _ends_it(kept: Sequence[str]) -> bool:
    """Whether the last line is words below a table, such as *End of data*: no cells, and no number."""
    last, before = kept[-1], kept[-2]
    divided = [one for one in SEPARATORS if one in before]
    return (
        bool(divided) and not any(one in last for one in divided) and any(map(str.isalpha, last)) and not re.search(r"\d", last)
    )


def _has(line: str, names: Collection[str], separator: str) -> bool:
    return set(names) <= {cell.strip().strip('"') for cell in cells_of(line, separator)}


def _rows(lines: Iterable[str], comment: str | None) -> list[str]:
    return [line for line in lines if line.strip() and not (comment and line.startswith(comment))][:JUDGED]


def _separator(rows: list[str]) -> str:
    return next((one for one in (*SEPARATORS, BLANKS) if _separates(rows, one)), "")


def _separates(rows: list[str], separator: str) -> bool:
    if separator != BLANKS and not any(separator in row for row in rows[:2]):
        return False
    table = [cells_of(row, separator) for row in rows]
    if len(table) < 2:
        return any(len(row) > 1 for row in table)
    # the last row may be cut off
    body = table[1:-1] or table[1:]
    width, head = _width(body), len(table[0])
    usual = sum(len(row) == width for row in body) >= MOST * len(body)
    return bool(usual and head > 1 and width > 1 and max(map(len, body)) <= max(width, head) and width <= head + 1)


def _width(table: Sequence[list[str]]) -> int:
    return Counter(map(len, table)).most_common(1)[0][0] if table else 0


def _has_decimal_comma(cells: list[str], separator: str) -> bool:
    """Whether the numbers of a table have decimal commas; between commas as separators they are quoted."""
    commas = [cell for one in cells if COMMA.fullmatch(cell := one.strip()) or THOUSANDS.fullmatch(cell)]
    # dates have points as well, and thousands
    pointed = (cell for cell in cells if "." in cell and _is_number(cell))
    if not commas or not all(THOUSANDS.fullmatch(cell.strip().replace(".", ",")) for cell in pointed):
        return False
    return separator != "," or not all(THOUSANDS.fullmatch(cell) for cell in commas)


def _has_header(table: list[list[str]], has_comma: bool) -> bool:
    """Whether the first row holds names: what is a number below it is none there, or is written otherwise."""
    if len(table) < 2:
        return True
    first, rows = table[0], [row for row in table[1:] if len(row) >= len(table[0])]
    kinds = [[_is_number(cell.replace(",", ".") if has_comma else cell) for cell in row] for row in table[:2]]
    if not any(kinds[1]) or kinds[0] != kinds[1]:
        return True
    if len(first) < 2 or not rows or not all(DIGITS.fullmatch(cell.strip()) for cell in first):
        return False
    # labels of a data frame: whole numbers over columns that have decimals in every row
    if any(not any(DIGITS.fullmatch(row[k].strip()) for row in rows) for k in range(len(first))):
        return True
    if [int(cell) for cell in first] in (list(range(len(first))), list(range(1, len(first) + 1))):
        listed = ", ".join(cell.strip() for cell in first[:4])
        more = ", ..." if len(first) > 4 else ""
        raise UsageError(f"the first row is {listed}{more}: say in the map header: true or header: false")
    return False


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
