"""Where the rows of a table of text begin, and what the lines above them call the columns and their units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from hjcamp.records.elsewhere.reader import Column
from hjcamp.records.elsewhere.text_table import BLANKS, REMARKS, SEPARATORS, cells_of
from hjcamp.records.units import is_own_unit, is_unit

LOOKED_AT = 1000
SEEN = 4  # rows in turn that look like rows
ABOVE = 4  # lines above the rows that may hold names, units, types
NO_READING = ("", "nan", "na", "n/a", "null", "none", "-", "--", "---", "inf", "-inf", "true", "false", "on", "off")
# A date or a time of day; with the names of months, days and halves of a day where it has a time.
TIME = re.compile(r"(?=.*\d)[\d:.,/TZ+\- ]+|(?=.*\d:\d\d)[\w:.,/+\- ]+")
#: How a unit stands behind a name: x [mm], x (mm), x (mm, absolute), x {mm}, x, mm, x / mm.
BRACKETED = re.compile(r"(?P<name>.*?)\s*[\[({<](?P<unit>[^\[\](){}<>,;]*?)(?:(?:[,;]|\ssince\s)[^\[\](){}<>]*)?[\])}>]\s*")
DIVIDED = re.compile(r"(?P<name>.*?)\s*(?:,\s+|\s/\s*|;\s*)(?P<unit>\S+)")
COMPACT = re.compile(r"(?P<name>[^/]+)/(?P<unit>[^/\s]+)")
NO_QUANTITY = "NAWKCJ"  # letters that are units, as in N/mm; x/mm, F/N and T/K are quantities by their units
NONE = ("", "-", "1", "none", "na", "n/a")
TYPES = re.compile(
    r"(?:u?int|float|real|double|single|bool(?:ean)?|string|text|numeric|number|datetime|date|time)(?:8|16|32|64)?"
)


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
    labelled = [
        (number, cells)
        for number in _above(lines, first, used)
        if (cells := _labels(lines[number], used, width, number == first - 1))
    ]
    names, units, plain, below = _names_and_units(labelled, first)
    if plain and not lines[names[0]].lstrip().startswith(REMARKS) and _cells(lines[names[0]], used)[:width] == names[1]:
        columns = [Column(name, unit or unit_in(name)[1]) for name, unit in zip(names[1], units or [""] * width, strict=True)]
        return Head(_as_labview_says(columns, lines[:first], used), {"units_below": True} if below else {})
    said, units = names[1] or [""] * width, units or [""] * width
    columns = [Column(str(k + 1), units[k] or unit_in(said[k])[1], said=said[k]) for k in range(width)]
    return Head(columns, {"header": False, **({"skip_lines": first} if first else {})})


def _as_labview_says(columns: list[Column], above: Sequence[str], separator: str) -> list[Column]:
    """Return columns with the units of a LabVIEW measurement's header, where one column of times stands before all channels."""
    known = {cells[0]: cells[1:] for line in above if (cells := _cells(line, separator))}
    if columns[0].name != "X_Value" or known.get("X_Columns") != ["One"] or known.get("X_Dimension", [""])[0] != "Time":
        return columns
    units = [*known.get("Y_Unit_Label", []), *([""] * len(columns))]
    return [
        Column("X_Value", "s", said="time"),
        *(replace(one, unit=one.unit or unit) for one, unit in zip(columns[1:], units, strict=False)),
    ]


def _names_and_units(
    labelled: Sequence[tuple[int, list[str]]], first: int
) -> tuple[tuple[int, list[str]], list[str], bool, bool]:
    """Return the line of names with its cells, the units, whether an import finds that line by its names, whether units are below.

    ``labelled`` are the lines above row ``first`` that have a cell for each column, the nearest one first: of those that are neither
    units nor types the nearest one whose cells differ holds the names.
    """
    of_units = next((k for k, (_, cells) in enumerate(labelled[1:], 1) if _are_units(cells, all_of_them=True)), None)
    if len(labelled) > 1 and _are_units(labelled[0][1]) and _are_names(labelled[1][1]):
        of_units = 0
    others = [
        one for k, one in enumerate(labelled) if k != of_units and not all(TYPES.fullmatch(cell.casefold()) for cell in one[1])
    ]
    if not others or others[0][0] < first - ABOVE:
        return (0, []), [], False, False
    names = next((one for one in others if _are_names(one[1])), others[0])
    units = [] if of_units is None else [cell.strip("[](){}") for cell in labelled[of_units][1]]
    place = labelled.index(names)
    below = of_units == 0 and place == 1
    plain = _are_names(names[1]) and (place == 0 or below)
    return names, units, plain, below


def unit_in(label: str) -> tuple[str, str]:
    """Return the name and the unit (empty: none) of a label: ``x [mm]``, ``x (mm)``, ``x, mm``, ``x / mm``, ``x/mm``, ``v_m/s``."""
    for pattern in (BRACKETED, DIVIDED):
        found = pattern.fullmatch(label)
        unit = found["unit"].strip() if found else ""
        if found and (is_unit(unit) or unit in NONE):
            return found["name"], unit
        if found and label.isupper() and is_unit(unit.casefold()):
            return found["name"], unit.casefold()
    found = COMPACT.fullmatch(label)
    alone = is_own_unit(label) or bool(found and is_unit(label) and (len(found["name"]) > 1 or found["name"] in NO_QUANTITY))
    if found and not alone and is_unit(found["unit"]):
        name, _, end = found["name"].replace(" ", "_").rpartition("_")
        return (name, f"{end}/{found['unit']}") if name and is_unit(end) else (found["name"], found["unit"])
    return label, ""


def _first_rows(lines: Sequence[str], separator: str) -> tuple[int, int]:
    """Return the number of the first row, and how many cells rows have (0: none are found)."""
    cells = [_cells(line, separator) for line in lines]
    filled = [k for k, one in enumerate(cells) if one != [""]]
    for at, k in enumerate(filled):
        some = [cells[j] for j in filled[at : at + SEEN]]
        several = separator == BLANKS or len(cells[k]) > 1 or len(filled) == len(some)
        if several and len({len(one) for one in some}) == 1 and all(_is_row(one) for one in some):
            return k, len(cells[k])
    return 0, 0


def _is_row(cells: list[str]) -> bool:
    numbers = [_is_number(cell) for cell in cells]
    return any(numbers) and all(
        number or cell.casefold() in NO_READING or TIME.fullmatch(cell) for number, cell in zip(numbers, cells, strict=True)
    )


def _is_number(cell: str) -> bool:
    # between commas as separators a cell with a comma was quoted
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _cells(line: str, separator: str) -> list[str]:
    found = [cell.strip().strip('"').strip() for cell in cells_of(line.strip("\r\n "), separator)] or [""]
    return found[:-1] if len(found) > 1 and not found[-1] and separator != BLANKS else found


def _above(lines: Sequence[str], first: int, separator: str) -> list[int]:
    """Return the lines above the first row up to one without any value, at most ``ABOVE``; one such may stand right above the row."""
    found: list[int] = []
    for number in range(first - 1, max(first - 2 - ABOVE, -1), -1):
        if not any(_cells(lines[number], separator)) and number < first - 1:
            break
        found += [number] if any(_cells(lines[number], separator)) else []
    return found[:ABOVE]


def _are_names(cells: list[str]) -> bool:
    return all(cells) and len(set(cells)) == len(cells)


def _are_units(cells: list[str], all_of_them: bool = False) -> bool:
    """Whether cells next to a header are units: most of those that hold anything, or all of them."""
    said = [one for cell in cells if (one := cell.strip("[](){}")) not in NONE]
    share = 1.0 if all_of_them else 0.5
    return sum(is_unit(one) for one in said) >= max(1, share * len(said))


def _labels(line: str, separator: str, width: int, nearest: bool) -> list[str]:
    """Return the cells of a line above the rows, one for each column; none where it has not so many.

    A remark, and the line right above the rows, may have another separator; between blanks a unit in brackets is a cell by itself.
    """
    remark = line.lstrip().startswith(REMARKS)
    text = line.strip().lstrip("".join(REMARKS)).strip() if remark else line
    for one in (separator, *SEPARATORS, BLANKS) if remark or nearest else (separator,):
        found = _cells(text, one)
        if one == BLANKS and len(found) == 2 * width and all(cell[0] in "[({<" for cell in found[1::2]):
            return [f"{name} {unit}" for name, unit in zip(found[::2], found[1::2], strict=True)]
        # a comment may stand behind a row, and its name behind the others
        if len(found) == width or (one == separator != BLANKS and len(found) == width + 1):
            return found[:width] if any(found) and not _is_row(found[:width]) else []
    return []
