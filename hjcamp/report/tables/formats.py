"""Write a sheet as Markdown and LaTeX."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hjcamp.errors import visible
from hjcamp.report.tables.sheet import Cell, Sheet

FORMULAS = tuple("=+-@\t\r")
NUMBER = re.compile(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?")
IN_MARKDOWN = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "|": "\\|", "`": "\\`", "[": "\\[", "]": "\\]", "\\": "\\\\"}
IN_LATEX = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "|": r"$|$",
    "±": r"$\pm$",
    "↓": r"$\downarrow$",
    "↑": r"$\uparrow$",
    "▲": r"$\bigtriangleup$",
    "▼": r"$\bigtriangledown$",
    "–": "--",
}


def to_markdown(sheet: Sheet) -> str:
    """Return the sheet as a Markdown table with its title, source and notes."""

    def line(texts: Sequence[str], mark: str = "") -> str:
        return "| " + " | ".join(f"{mark}{escape_markdown(text)}{mark}" if text else "" for text in texts) + " |"

    lines = [f"## {escape_markdown(sheet.title)}", ""]
    lines += [line(sheet.headers), "|" + "|".join("---" for _ in sheet.headers) + "|"]
    for row in sheet.rows:
        texts = [_marked(cell) for cell in row]
        if row[0].kind == "block":
            texts = [row[0].text, *[""] * (len(sheet.headers) - 1)]
        lines.append(line(texts, "**" if row[0].kind == "block" else ""))
    lines += ["", *[f"* {escape_markdown(note)}" for note in _notes(sheet)]]
    return "\n".join(lines).rstrip() + "\n"


def to_latex(sheet: Sheet) -> str:
    """Return the sheet as a LaTeX table with rules of the package booktabs."""
    width = len(sheet.headers)
    lines = [
        "% needs \\usepackage{booktabs}",
        "\\begin{table}",
        "\\centering",
        f"\\caption{{{escape_latex(sheet.title)}}}",
        f"\\label{{tab:{sheet.name.replace('_', '-')}}}",
        f"\\begin{{tabular}}{{{'l' * width}}}",
        "\\toprule",
        " & ".join(escape_latex(header) for header in sheet.headers) + " \\\\",
        "\\midrule",
    ]
    for row in sheet.rows:
        if row[0].kind == "block":
            lines.append(f"\\multicolumn{{{width}}}{{l}}{{\\emph{{{escape_latex(row[0].text)}}}}} \\\\")
        else:
            lines.append(" & ".join(escape_latex(_marked(cell)) for cell in row) + " \\\\")
    lines += ["\\bottomrule", "\\end{tabular}"]
    lines += [f"\\par\\footnotesize {escape_latex(note)}" for note in _notes(sheet)]
    return "\n".join([*lines, "\\end{table}", ""])


def escape_latex(text: str) -> str:
    """Return ``text`` with every character that LaTeX would read as a command replaced, on one line."""
    return "".join(IN_LATEX.get(character, character) for character in visible(" ".join(text.split())))


def escape_markdown(text: str) -> str:
    """Return ``text`` for a line or a cell of Markdown: no HTML, no link, picture or code of its own."""
    plain = visible(re.sub(r"\s", " ", text))
    return "".join(IN_MARKDOWN.get(character, character) for character in plain)


def escape_csv(text: str) -> str:
    """Return ``text`` for a cell of CSV, which no spreadsheet takes for a formula: a quote stands before what looks like one."""
    return f"'{text}" if text[:1] in FORMULAS and not NUMBER.fullmatch(text) else text


def _marked(cell: Cell) -> str:
    return f"{cell.text} {cell.mark}".strip()


def _notes(sheet: Sheet) -> list[str]:
    source = [f"Layout: {sheet.source}. Mean ± sample standard deviation in deg, n tests."] if sheet.source else []
    return [*source, *sheet.notes]
