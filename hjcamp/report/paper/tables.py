"""Tables for LaTeX: numbers in columns of siunitx, aligned at the decimal point, with readable names."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hjcamp.report.formats import escape_latex
from hjcamp.report.names import readable
from hjcamp.report.paper.names import header
from hjcamp.report.paper.numbers import unit_latex
from hjcamp.report.sheet import NO_TEST, Cell, Sheet

NEEDS = "% needs \\usepackage{booktabs,graphicx,siunitx}"
#: A table that is wider than the text is made smaller; no other is.
FITTED = r"\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{%"
#: A number, and what may stand behind it: its deviation, a mark, an arrow, a change in brackets.
VALUE = re.compile(r"(-?)(\d+)(?:\.(\d+))?(?: ([^\w\s].*))?")
DEVIATION = "In a table, ± is the sample standard deviation s of the n tests, with the digits that were printed where it is published."
UNIT = "unit"
ANGLES = ("RMSE1", "RMSE2", "e|max", "SSE")


def paper_table(sheet: Sheet, label: str) -> str:
    """Return a sheet as a LaTeX table; a column that holds numbers alone is one of siunitx."""
    rows = [row for row in sheet.rows if row[0].kind != "block"]
    columns = list(range(len(sheet.headers)))
    formats = {place: _format([row[place] for row in rows if place < len(row)]) for place in columns}
    # What stands behind a number has a narrow column of its own: siunitx 2 and 3 make room for it in different ways.
    marked = {place for place in columns if formats[place] and any(_after(row[place]) for row in rows)}
    spec = "".join(_kind(formats[place], place in marked) for place in columns)
    blocks = len(rows) < len(sheet.rows)
    heads = [
        (f"{{{_heading(text, blocks)}}}" if formats[place] else _heading(text, blocks)) + (" &" if place in marked else "")
        for place, text in enumerate(sheet.headers)
    ]
    lines = [
        NEEDS,
        r"\begin{table}",
        r"\centering\small\setlength{\tabcolsep}{4pt}",
        rf"\caption{{{escape_latex(sheet.title)}}}",
        rf"\label{{tab:{label}}}",
        FITTED,
        rf"\begin{{tabular}}{{{spec}}}",
        r"\toprule",
        " & ".join(heads) + r" \\",
        r"\midrule",
    ]
    for row in sheet.rows:
        if row[0].kind == "block":
            lines.append(
                rf"\multicolumn{{{len(columns) + len(marked)}}}{{l}}{{\emph{{{header_of_block(row[0].text)}}}}} \\"
            )
        else:
            cells = [_cell(cell, bool(formats[place]), sheet.headers[place]) for place, cell in enumerate(row)]
            behind = [f" & {escape_latex(_after(cell))}" if place in marked else "" for place, cell in enumerate(row)]
            lines.append(" & ".join(map("".join, zip(cells, behind, strict=True))) + r" \\")
    lines += [r"\bottomrule", r"\end{tabular}}"]
    deviation = [DEVIATION] if any(" ± " in cell.text for row in rows for cell in row) else []
    lines += [rf"\par\footnotesize {escape_latex(note)}" for note in [*deviation, *sheet.notes]]
    return "\n".join([*lines, r"\end{table}", ""])


def _heading(text: str, blocks: bool) -> str:
    """Return the heading of a column with the unit of an angle's error; where a table has blocks these say it."""
    angle = not blocks and text.strip("|") in ANGLES
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


def _kind(number: str, marked: bool) -> str:
    return (f"S[table-format={number}]" if number else "l") + (r"@{\,}l" if marked else "")


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
