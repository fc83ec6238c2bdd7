"""One self-contained page of a comparison or a diagnosis: sentences, tables, pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from hjcamp.report.pages.page import shaded
from hjcamp.report.pages.template import page_of
from hjcamp.report.pictures.conditions import tidy
from hjcamp.report.wording.glossary import glossed, words_of

PLACES = 8


def discrepancy_page(title: str, lead: str, parts: Sequence[str]) -> str:
    """Return the HTML; ``lead`` is the answer in one line, ``parts`` are blocks made by the functions below."""
    said = f'<p class="verdict">{glossed(lead)}</p>\n' if lead else ""
    body = "\n".join(part for part in parts if part)
    return page_of(title, f"<h1>{escape(title)}</h1>\n{said}{body}\n{words_of(said + body)}")


def heading(text: str) -> str:
    """Return the heading of a section."""
    return f"<h2>{glossed(text)}</h2>"


def note(text: str) -> str:
    """Return a paragraph in the softer shade."""
    return f'<p class="soft">{glossed(text)}</p>'


def bullets(lines: Sequence[str]) -> str:
    """Return sentences as a list."""
    return "<ul>" + "".join(f"<li>{glossed(line)}</li>" for line in lines) + "</ul>" if lines else ""


def picture(caption: str, svg: str) -> str:
    """Return a picture under its caption, in the shades of the page."""
    return f"<h3>{glossed(caption)}</h3>\n<figure>{shaded(tidy(svg), caption)}</figure>"


def side_by_side(pictures: Sequence[tuple[str, str]]) -> str:
    """Return pictures with what they show in words, next to each other, one below the other where the page is narrow."""
    if not pictures:
        return ""
    return (
        '<div class="evidence">' + "".join(f"<figure>{shaded(tidy(svg), told)}</figure>" for told, svg in pictures) + "</div>"
    )


def place_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the largest places of an answer's ``where`` as a table, nothing where there is none."""
    if not rows:
        return ""
    table = table_of(("subsystem", "by", "where", "share", "z"), [place_cells(row) for row in rows[:PLACES]])
    said = "The cuts by different variables are alternative breakdowns of the same error, so they do not add up."
    more = f" {PLACES} of {len(rows)} rows; all are in the answer for programs (--json)." if len(rows) > PLACES else ""
    sign = (
        "z: the mean over the tests in standard errors, from the scatter between repetitions; in a part + where the model reads too "
        "high (model - measured), of a subsystem as a whole + where its error is above repeatability."
    )
    return table + note(f"{said} {sign}{more}")


def place_cells(row: Mapping[str, Any]) -> list[str]:
    """Return the cells of one row of ``where``."""
    variable = "" if row["variable"] == "all" else str(row["variable"]).replace("_", " ")
    place = "as a whole" if row["variable"] == "all" else str(row["bin"])
    return [str(row["subsystem"]), variable, place, f"{100 * row['share']:.0f} %", f"{row['z']:+.0f}"]


def table_of(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table."""
    head = "".join(f'<th scope="col">{glossed(name)}</th>' for name in headings)
    body = "\n".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'
