"""Where the rows of a table of text begin, and what the lines above them call the columns and their units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from hjcamp.records.elsewhere.reader import Column
from hjcamp.records.elsewhere.text_table import BLANKS, REMARKS, SEPARATORS, cells_of
from hjcamp.records.units import is_unit

LOOKED_AT = 1000
SEEN = 4  # rows in turn that look like rows
NO_READING = ("", "nan", "na", "n/a", "null", "none", "-", "--", "---", "inf", "-inf", "true", "false", "on", "off")
# A date or a time of day.
TIME = re.compile(r"(?=.*\d)[\d:.,/TZ+\- ]+")
#: How a unit stands behind a name: x [mm], x (mm), x {mm}, x, mm, x / mm.
BRACKETED = re.compile(r"(?P<name>.*?)\s*[\[({<](?P<unit>[^\[\](){}<>]*)[\])}>]\s*")
DIVIDED = re.compile(r"(?P<name>.*?)\s*(?:,\s+|\s/\s*|;\s*)(?P<unit>\S+)")
NONE = ("", "-", "1", "none", "na", "n/a")


@dataclass(frozen=True)
class Head:
    """The columns of a table, and the keys of a map with which an import finds them."""

    columns: list[Column]
    keys: dict[str, object] = field(default_factory=dict)


def head_of(lines: Sequence[str], separator: str = "") -> Head:
    """Return what stands above the first rows of numbers; without a header columns are called 1, 2, 3, ..."""
    tried = [separator] if separator else [*SEPARATORS, BLANKS]
    rows = [(first, width, one) for one in tried for first, width in [_first_rows(lines[:LOOKED_AT], one)] if width]
    if not rows:
        return Head([])
    first, width, used = next((one for one in rows if one[1] > 1), rows[0])
    above = [(number, cells) for number in range(first - 1, -1, -1) if (cells := _cells(lines[number], used)) != [""]]
    headers = [(number, cells) for number, cells in above[:2] if len(cells) == width and any(cells)]
    units = [""] * width
    below = bool(len(headers) == 2 and above[0][0] == headers[0][0] and _are_units(headers[0][1]))
    if below:
        units = [cell.strip("[](){}") for cell in headers[0][1]]
        headers = headers[1:]
    elif len(headers) == 2:
        headers = headers[:1]
    names = headers[0][1] if headers and headers[0][0] >= first - 2 else []
    plain = bool(names) and len(set(names)) == width and all(names) and not lines[headers[0][0]].lstrip().startswith(REMARKS)
    if plain:
        columns = [Column(name, unit or unit_in(name)[1]) for name, unit in zip(names, units, strict=True)]
        return Head(columns, {"units_below": True} if below else {})
    said = names or _of_remark(lines[first - 1] if first else "", used, width)
    columns = [Column(str(k + 1), units[k] or unit_in(said[k])[1], said=said[k]) for k in range(width)]
    return Head(columns, {"header": False, **({"skip_lines": first} if first else {})})


def unit_in(label: str) -> tuple[str, str]:
    """Return the name and the unit (empty: none) of a label such as ``x [mm]``, ``x (mm)``, ``x, mm``, ``x / mm`` or ``x_mm``."""
    for pattern in (BRACKETED, DIVIDED):
        found = pattern.fullmatch(label)
        if found and (is_unit(found["unit"]) or found["unit"].strip() in NONE):
            return found["name"], found["unit"].strip()
    return label, ""


def _first_rows(lines: Sequence[str], separator: str) -> tuple[int, int]:
    """Return the number of the first row, and how many cells rows have (0: none are found)."""
    cells = [_cells(line, separator) for line in lines]
    filled = [k for k, one in enumerate(cells) if one != [""]]
    for at, k in enumerate(filled):
        some = [cells[j] for j in filled[at : at + SEEN]]
        several = separator == BLANKS or len(cells[k]) > 1 or len(filled) == len(some)
        if several and len({len(one) for one in some}) == 1 and all(_is_row(one, separator) for one in some):
            return k, len(cells[k])
    return 0, 0


def _is_row(cells: list[str], separator: str) -> bool:
    numbers = [_is_number(cell, separator) for cell in cells]
    return any(numbers) and all(
        number or cell.casefold() in NO_READING or TIME.fullmatch(cell) for number, cell in zip(numbers, cells, strict=True)
    )


def _is_number(cell: str, separator: str) -> bool:
    try:
        float(cell if separator == "," else cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _cells(line: str, separator: str) -> list[str]:
    found = [cell.strip().strip('"').strip() for cell in cells_of(line.strip("\r\n "), separator)] or [""]
    return found[:-1] if len(found) > 1 and not found[-1] and separator != BLANKS else found


def _are_units(cells: list[str]) -> bool:
    """Whether the cells below a header are units: most of those that hold anything."""
    said = [cell.strip("[](){}") for cell in cells]
    return sum(is_unit(one) for one in said if one not in NONE) >= max(1, 0.5 * sum(one not in NONE for one in said))


def _of_remark(line: str, separator: str, width: int) -> list[str]:
    """Return the names in a remark above rows, such as ``# t x u``."""
    text = line.strip().lstrip("".join(REMARKS)).strip()
    found = [_cells(text, one) for one in (separator, *SEPARATORS, BLANKS) if text]
    return next((one for one in found if len(one) == width), [""] * width)
