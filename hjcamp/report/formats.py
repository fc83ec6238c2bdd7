"""Write a sheet as Markdown and LaTeX."""

from __future__ import annotations

from collections.abc import Sequence

from hjcamp.report.sheet import Cell, Sheet

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

    def line(texts: Sequence[str]) -> str:
        return "| " + " | ".join(text.replace("|", "\\|").replace("\n", " ") for text in texts) + " |"

    lines = [f"## {sheet.title}", ""]
    lines += [line(sheet.headers), "|" + "|".join("---" for _ in sheet.headers) + "|"]
    for row in sheet.rows:
        texts = [_marked(cell) for cell in row]
        if row[0].kind == "block":
            texts = [f"**{row[0].text}**", *[""] * (len(sheet.headers) - 1)]
        lines.append(line(texts))
    lines += ["", *[f"* {note}" for note in _notes(sheet)]]
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
    """Return ``text`` with every character that LaTeX would read as a command replaced."""
    return "".join(IN_LATEX.get(character, character) for character in text)


def _marked(cell: Cell) -> str:
    return f"{cell.text} {cell.mark}".strip()


def _notes(sheet: Sheet) -> list[str]:
    source = [f"Layout: {sheet.source}. Mean ± sample standard deviation in deg, n tests."] if sheet.source else []
    return [*source, *sheet.notes]
