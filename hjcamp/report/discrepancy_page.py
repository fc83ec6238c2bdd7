"""One self-contained page of a comparison or a diagnosis: sentences, tables, pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from hjcamp.report.figures import tidy
from hjcamp.report.page import SHADES, STYLE


def discrepancy_page(
    title: str,
    sentences: Sequence[str],
    headings: Sequence[str],
    table: Sequence[Sequence[str]],
    where: Sequence[Mapping[str, Any]],
    pictures: Sequence[tuple[str, str]],
) -> str:
    """Return the HTML; ``where`` are the rows of the answer, ``pictures`` captions with their SVG. Texts are escaped."""
    places = [place_cells(row) for row in where]
    said = "".join(f"<li>{escape(line)}</li>" for line in sentences)
    shown = "\n".join(f"<h3>{escape(name)}</h3>\n<figure>{_shaded(svg)}</figure>" for name, svg in pictures)
    located = table_of(("subsystem", "by", "where", "share", "z"), places) if places else ""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{escape(title)}</title>\n'
        f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head>\n<body>\n<h1>{escape(title)}</h1>\n"
        f"<ul>{said}</ul>\n{table_of(headings, table)}\n{shown}\n<h2>Where</h2>\n{located}\n</body>\n</html>\n"
    )


def place_cells(row: Mapping[str, Any]) -> list[str]:
    """Return the cells of one row of ``where``."""
    names = [str(row["subsystem"]), str(row["variable"]).replace("_", " "), str(row["bin"])]
    return [*names, f"{100 * row['share']:.1f} %", f"{row['z']:+.1f}"]


def table_of(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in headings)
    body = "\n".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'


def _shaded(svg: str) -> str:
    svg = tidy(svg)
    for colour, shade in SHADES.items():
        svg = svg.replace(colour, shade)
    return svg
