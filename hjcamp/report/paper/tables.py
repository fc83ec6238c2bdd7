"""Tables for LaTeX: numbers in columns of siunitx, aligned at the decimal point, with readable names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from hjcamp.report.paper.names import header
from hjcamp.report.paper.numbers import unit_latex
from hjcamp.report.tables.formats import escape_latex
from hjcamp.report.tables.sheet import NO_TEST, REFERENCE_COLUMNS, Cell, Sheet
from hjcamp.report.wording.names import readable

NEEDS = "% needs \\usepackage{amssymb,booktabs,siunitx}"
#: Of small type (9 points), on average.
CHARACTER_MM = 1.6
#: Characters of a column of words that is not broken into lines.
LONGEST = 40
#: A number, and what may stand behind it: its deviation, a mark, an arrow, a change in brackets.
VALUE = re.compile(r"(-?)(\d+)(?:\.(\d+))?(?: ([^\w\s].*))?")
DEVIATION = (
    "In a table, ± is the sample standard deviation s of the n tests, with the digits that were printed where it is published."
)
DEFINED = {
    "RMSE1": "RMSE1: root mean square of the error of the arm's angle over the command phase.",
    "RMSE2": "RMSE2: the same without its first 0.25 s.",
    "e|max": "|e|max: the largest magnitude of that error.",
    "SSE": "SSE: its mean from 0.2 s after the reference last changed, of cycloids.",
}
UNIT = "unit"
ANGLES = ("RMSE1", "RMSE2", "e|max", "SSE")


def paper_table(sheet: Sheet, label: str, column_mm: float = 150.0, text_mm: float | None = None) -> str:
    """Return a sheet as a LaTeX table; a column that holds numbers alone is one of siunitx.

    What is wider than a column of the text (mm) goes across all of them, what is wider than these (``text_mm``) into several
    blocks of columns below each other, the keys again in each; no type is scaled.
    """
    sheet = _said_once(sheet)
    wide = _width_mm(sheet, range(len(sheet.headers))) > column_mm
    kind = "table*" if wide else "table"
    lines = [NEEDS, rf"\begin{{{kind}}}", r"\centering\small\setlength{\tabcolsep}{4pt}"]
    lines += [rf"\caption{{{escape_latex(sheet.title)}}}", rf"\label{{tab:{label}}}"]
    for number, columns in enumerate(_packed(sheet, (text_mm or column_mm) if wide else column_mm)):
        lines += [r"\par\medskip"] * bool(number) + _tabular(sheet, columns)
    deviation = [DEVIATION] if any(" ± " in cell.text for row in sheet.rows for cell in row) else []
    named = {word.strip("|") for word in (*sheet.headers, *(row[0].text.partition(",")[0] for row in sheet.rows))}
    defined = [text for name, text in DEFINED.items() if name in named]
    lines += [rf"\par\footnotesize {escape_latex(note)}" for note in [*defined, *deviation, *sheet.notes]]
    return "\n".join([*lines, rf"\end{{{kind}}}", ""])


def _tabular(sheet: Sheet, columns: Sequence[int]) -> list[str]:
    """Return the lines of some columns of a sheet."""
    rows = [row for row in sheet.rows if row[0].kind != "block"]
    formats = {place: _format([row[place] for row in rows if place < len(row)]) for place in columns}
    # What stands behind a number has a narrow column of its own: siunitx 2 and 3 make room for it in different ways.
    marked = {place for place in columns if formats[place] and any(_after(row[place]) for row in rows)}
    longest = {place: max((len(row[place].text) for row in rows if place < len(row)), default=0) for place in columns}
    spec = "".join(_kind(formats[place], place in marked, longest[place]) for place in columns)
    heads = [
        (f"{{{_heading(sheet, place)}}}" if formats[place] else _heading(sheet, place)) + (" &" if place in marked else "")
        for place in columns
    ]
    lines = [rf"\begin{{tabular}}{{{spec}}}", r"\toprule", " & ".join(heads) + r" \\", r"\midrule"]
    for row in sheet.rows:
        if row[0].kind == "block":
            lines.append(rf"\multicolumn{{{len(columns) + len(marked)}}}{{l}}{{\emph{{{header_of_block(row[0].text)}}}}} \\")
        else:
            cells = [_cell(row[place], bool(formats[place]), sheet.headers[place]) for place in columns]
            behind = [f" & {escape_latex(_after(row[place]))}" if place in marked else "" for place in columns]
            lines.append(" & ".join(map("".join, zip(cells, behind, strict=True))) + r" \\")
    return [*lines, r"\bottomrule", r"\end{tabular}"]


def _said_once(sheet: Sheet) -> Sheet:
    """Return a sheet without the column of conditions where the choices in the columns behind it say the same."""
    rows = [row for row in sheet.rows if row[0].kind != "block"]
    keys = [place for place, cell in enumerate(rows[0] if rows else []) if cell.kind == "key"]
    if sheet.headers[:1] != ["condition"] or not keys[1:]:
        return sheet
    if any(set(row[0].text.split("__")) - {row[place].text for place in keys[1:]} for row in rows):
        return sheet
    return replace(sheet, headers=sheet.headers[1:], rows=[row if row[0].kind == "block" else row[1:] for row in sheet.rows])


def _width_mm(sheet: Sheet, columns: Iterable[int]) -> float:
    """Return about how wide these columns are in small type."""
    rows = [row for row in sheet.rows if len(row) == len(sheet.headers)]
    texts = {
        place: [sheet.headers[place] + " (deg)", *(f"{row[place].text} {row[place].mark}" for row in rows)] for place in columns
    }
    return CHARACTER_MM * sum(min(max(map(len, found)), LONGEST) + 2 for found in texts.values())


def _packed(sheet: Sheet, width_mm: float) -> list[list[int]]:
    """Return the columns of each block: as many as fit, and what is published always with its mean."""
    keys = [place for place, cell in enumerate(sheet.rows[-1] if sheet.rows else []) if cell.kind == "key"]
    groups: list[list[int]] = []
    for place, name in enumerate(sheet.headers):
        if place in keys:
            continue
        if name in REFERENCE_COLUMNS and groups:
            groups[-1].append(place)
        else:
            groups.append([place])
    blocks: list[list[int]] = []
    for group in groups:
        if blocks and _width_mm(sheet, [*blocks[-1], *group]) <= width_mm:
            blocks[-1] += group
        else:
            blocks.append([*keys, *group])
    return blocks or [keys]


def _heading(sheet: Sheet, place: int) -> str:
    """Return the heading of a column with the unit of an angle's error; where a table has blocks these say it."""
    text = sheet.headers[place]
    mean = sheet.headers[place - 1] if text in REFERENCE_COLUMNS and place else text
    angle = mean.strip("|") in ANGLES and all(row[0].kind != "block" for row in sheet.rows)
    return f"{header(text)} (deg)" if angle else header(text)


def plain_sheet(
    name: str, title: str, headers: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str] = ()
) -> Sheet:
    """Return texts as a sheet whose first column names the rows."""
    cells = [[Cell(text, "value" if place else "key") for place, text in enumerate(row)] for row in rows]
    return Sheet(name, title, "", list(headers), cells, list(notes))


def header_of_block(text: str) -> str:
    """Return the heading of a part of a table: an indicator and its unit."""
    name, comma, unit = text.partition(", ")
    return f"{header(name)}{f' ({escape_latex(unit)})' if comma else ''}"


def _format(cells: Sequence[Cell]) -> str:
    """Return the table-format of a column of numbers, empty where a text is among them."""
    found = [VALUE.fullmatch(cell.text) for cell in cells if cell.text not in ("", NO_TEST)]
    if not found or any(one is None for one in found) or all(cell.kind == "key" for cell in cells):
        return ""
    there = [one for one in found if one is not None]
    sign = "-" if any(one[1] for one in there) else ""
    digits = max(len(one[2]) for one in there)
    return f"{sign}{digits}.{max(len(one[3] or '') for one in there)}"


def _kind(number: str, marked: bool, longest: int) -> str:
    words = "l" if longest <= LONGEST else f"p{{{CHARACTER_MM * LONGEST:.0f}mm}}"
    return (f"S[table-format={number}]" if number else words) + (r"@{\,}l" if marked else "")


def _after(cell: Cell) -> str:
    found = VALUE.fullmatch(cell.text)
    return " ".join(filter(None, (found[4] if found else "", cell.mark)))


def _cell(cell: Cell, is_number: bool, heading: str) -> str:
    if not is_number and heading == UNIT and "deg" not in cell.text:
        return rf"\si{{{unit_latex(cell.text)}}}"
    if not is_number:
        return escape_latex(readable(cell.text) if cell.kind == "key" else f"{cell.text} {cell.mark}".strip())
    found = VALUE.fullmatch(cell.text)
    if found is None:
        return "{--}" if cell.text == NO_TEST else "{}"
    return f"{found[1]}{found[2]}" + (f".{found[3]}" if found[3] else "")
