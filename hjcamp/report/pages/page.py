"""The report page: one self-contained HTML file, light and dark, with nothing to fetch."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from hjcamp.report.pages.template import html, pieces_of
from hjcamp.report.pictures import conditions as figures
from hjcamp.report.pictures.conditions import tidy
from hjcamp.report.pictures.small_multiples import small_multiples
from hjcamp.report.runs.spread import Condition
from hjcamp.report.tables.sheet import REFERENCE_COLUMNS, Cell, Sheet
from hjcamp.report.wording.names import readable

#: The page's own shades, which follow light and dark, in place of the colours of the drawing.
SHADES = {
    figures.INK: "currentColor",
    figures.PAPER: "var(--paper)",
    figures.GRID: "var(--grid)",
    figures.BLUE: "var(--blue)",
    figures.RED: "var(--red)",
    figures.GREEN: "var(--green)",
    figures.PURPLE: "var(--purple)",
    figures.ORANGE: "var(--orange)",
    figures.TEAL: "var(--teal)",
}
#: Pixels of the screen for a point of the drawing, whose smallest letters have 7 points.
READABLE = 1.2
OVERVIEW = "every condition: mean and standard deviation of each indicator, published values next to them"


@dataclass(frozen=True)
class Picture:
    """A picture of the page: its caption, and what draws it as SVG when its turn comes."""

    caption: str
    draw: Callable[[], str]


@dataclass(frozen=True)
class _Drawn:
    """A condition as a template has it: its place in the page, and its picture when that is asked for."""

    name: str
    anchor: str
    picture: Picture

    @property
    def title(self) -> str:
        return readable(self.name)

    def html(self) -> Any:
        told = "angle, error, pressures, command"
        return html(picture_html(self.name, self.anchor, self.picture.draw(), self.picture.caption, told))


def build_page(
    *,
    title: str,
    facts: Sequence[str],
    verdict: str,
    overview: str = "",
    small: Sequence[Condition] = (),
    explorer: str = "",
    sheets: Sequence[Sheet],
    open_sheet: Sheet | None = None,
    pictures: Mapping[str, Picture],
    further: Mapping[str, tuple[str, str]] | None = None,
    origin: Sequence[tuple[str, str]],
    command: str,
    configuration: str,
    template: Path | None = None,
) -> Iterator[str]:
    """Yield the HTML of the report piece by piece, one picture after the other; every text is escaped.

    ``overview`` is the SVG of all conditions, ``small`` are those drawn small, ``open_sheet`` is a table that stands open
    below them, ``explorer`` is a block of HTML.
    ``template`` is a file of the user's (docs/templates.md).
    ``pictures`` are those of the conditions by name, ``further`` those of the campaign itself, heading -> (SVG, caption), which
    come first; ``origin`` are name and value of what made the run, ``command``
    runs it again.
    """
    drawn = [_Drawn(name, f"condition-{number}", one) for number, (name, one) in enumerate(pictures.items(), start=1)]
    numbered = {one.name: one.anchor for one in drawn}
    first = [
        picture_html(name, f"campaign-{number}", *one) for number, (name, one) in enumerate((further or {}).items(), start=1)
    ]
    return pieces_of(
        "report.html",
        title,
        template,
        facts=facts,
        verdict=verdict,
        further=html("\n".join(first)),
        overview=html(f"<figure>{shaded(tidy(overview), OVERVIEW)}</figure>" if overview else ""),
        small=html(small_multiples(small, numbered, {}) if small else ""),
        beside=html(table_html(open_sheet) if open_sheet else ""),
        explorer=html(explorer),
        tables=[html(folded(sheet)) for sheet in sheets],
        sheets=sheets,
        pictures=drawn,
        origin=origin,
        command=command,
        configuration=configuration,
    )


def folded(sheet: Sheet) -> str:
    """Return one sheet under its title, closed until it is asked for; a printer gets it open."""
    heading, _, rest = table_html(sheet).partition("\n")
    return f"<details>\n<summary>{heading}</summary>\n{rest}</details>"


def table_html(sheet: Sheet) -> str:
    """Return one sheet as a heading, a table and its notes."""
    headers = "".join(
        f'<th{_class("published" if header in REFERENCE_COLUMNS else "")} scope="col">{escape(header)}</th>'
        for header in sheet.headers
    )
    rows = "\n".join(_row_html(row, len(sheet.headers)) for row in sheet.rows)
    source = [f"Layout: {sheet.source}. Mean ± sample standard deviation, deg."] if sheet.source else []
    notes = "".join(f"<li>{escape(note)}</li>" for note in [*source, *sheet.notes])
    return (
        f'<h3 id="{escape(sheet.name)}">{escape(sheet.title)}</h3>\n<div class="scroll"><table>\n'
        f"<thead><tr>{headers}</tr></thead>\n<tbody>\n{rows}\n</tbody></table></div>\n"
        + (f'<ul class="notes">{notes}</ul>' if notes else "")
    )


def _row_html(row: Sequence[Cell], width: int) -> str:
    if row[0].kind == "block":
        return f'<tr><td class="block" colspan="{width}">{escape(row[0].text)}</td></tr>'
    return "<tr>" + "".join(_cell_html(cell) for cell in row) + "</tr>"


def _cell_html(cell: Cell) -> str:
    name = "far" if cell.mark else "published" if cell.kind == "published" else ""
    text = readable(cell.text) if cell.kind == "key" else cell.text
    return f"<td{_class(name)}>{escape(f'{text} {cell.mark}'.strip())}</td>"


def _class(name: str) -> str:
    return f' class="{name}"' if name else ""


def picture_html(name: str, anchor: str, svg: str, caption: str, told: str = "") -> str:
    """Return one picture under its heading, with its colours handed to the page."""
    name = readable(name)
    svg = shaded(svg, f"{name}: {told}" if told else name)
    heading = f'<h3 id="{anchor}">{escape(name)}</h3>'
    return f"{heading}\n<figure>\n<figcaption>{escape(caption)}</figcaption>\n{svg}</figure>"


def shaded(svg: str, told: str) -> str:
    """Return a drawing in the page's own shades, with words for who does not see it, no smaller than can be read.

    Where the page is narrower than that the picture is moved under its frame, as wide tables are.
    """
    for colour, shade in SHADES.items():
        svg = svg.replace(colour, shade)
    wide = re.search(r'viewBox="[\d.]+ [\d.]+ ([\d.]+) ', svg)
    least = f' style="min-width: {float(wide[1]) * READABLE:.0f}px"' if wide else ""
    return svg.replace("<svg ", f'<svg role="img" aria-label="{escape(told)}"{least} ', 1)
