"""The report page: one self-contained HTML file, light and dark, with nothing to fetch."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from hjcamp.report.explorer import NOTHING_FETCHED
from hjcamp.report.names import readable
from hjcamp.report.pictures import conditions as figures
from hjcamp.report.pictures.conditions import tidy
from hjcamp.report.pictures.small_multiples import small_multiples
from hjcamp.report.sheet import BESIDE, Cell, Sheet
from hjcamp.report.spread import Condition

STYLE = Path(__file__).with_name("page.css")
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
OVERVIEW = "every condition: mean and standard deviation of each indicator, published values beside"
ABOVE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
$policy
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
$style</style>
</head>
<body>
<h1>$title</h1>
<p class="soft">$facts</p>
$verdict
$further
$overview
$small
$beside
$explorer
<h2 id="tables">Tables</h2>
$tables
<h2 id="pictures">Conditions</h2>
<p class="soft">Lines are means over the repetitions where these move together; where they do not, one repetition is bold and the
others are thin. Bands run from the lowest to the highest of them, and of the samples that one point stands for.</p>
<nav>
$links
</nav>
""")
BELOW = Template("""
<h2 id="origin">Where this comes from</h2>
<div class="scroll"><table>
$origin
</table></div>
$again
$configuration
<script>addEventListener("beforeprint", () => { for (const one of document.querySelectorAll("details")) one.open = true; });</script>
</body>
</html>
""")


@dataclass(frozen=True)
class Picture:
    """A picture of the page: its caption, and what draws it as SVG when its turn comes."""

    caption: str
    draw: Callable[[], str]


def build_page(
    *,
    title: str,
    facts: Sequence[str],
    verdict: str,
    overview: str = "",
    small: Sequence[Condition] = (),
    explorer: str = "",
    sheets: Sequence[Sheet],
    beside: Sheet | None = None,
    pictures: Mapping[str, Picture],
    further: Mapping[str, tuple[str, str]] | None = None,
    origin: Sequence[tuple[str, str]],
    command: str,
    configuration: str,
) -> Iterator[str]:
    """Yield the HTML of the report piece by piece, one picture after the other; every text is escaped.

    ``overview`` is the SVG of all conditions, ``small`` are those drawn small, ``beside`` is a table that stands open
    below them, ``explorer`` is a block of HTML.
    ``pictures`` are those of the conditions by name, ``further`` those of the campaign itself, heading -> (SVG, caption), which
    come first; ``origin`` are name and value of what made the run, ``command``
    runs it again.
    """
    numbered = {name: f"condition-{number}" for number, name in enumerate(pictures, start=1)}
    again = f"<h3>Run it again</h3>\n<pre>{escape(command)}</pre>" if command else ""
    shown = f"<details><summary>Configuration as asked</summary>\n<pre>{escape(configuration)}</pre></details>"
    yield ABOVE.substitute(
        title=escape(title),
        style=STYLE.read_text(encoding="utf-8"),
        facts=escape(" · ".join(facts)),
        verdict=f'<p class="verdict">{escape(verdict)}</p>' if verdict else "",
        policy=NOTHING_FETCHED,
        beside=table_html(beside) if beside else "",
        further="\n".join(
            picture_html(name, f"campaign-{number}", *drawn) for number, (name, drawn) in enumerate((further or {}).items(), start=1)
        ),
        overview=f"<figure>{shaded(tidy(overview), OVERVIEW)}</figure>" if overview else "",
        small=small_multiples(small, numbered, {}) if small else "",
        explorer=explorer,
        tables="\n".join(folded(sheet) for sheet in sheets),
        links="\n".join(f'<a href="#{anchor}">{escape(readable(name))}</a>' for name, anchor in numbered.items()),
    )
    for number, (name, picture) in enumerate(pictures.items()):
        told = "angle, error, pressures, command"
        yield ("\n" if number else "") + picture_html(name, numbered[name], picture.draw(), picture.caption, told)
    yield BELOW.substitute(
        origin="\n".join(
            f'<tr><td>{escape(name)}</td><td class="fact">{escape(value)}</td></tr>' for name, value in origin
        ),
        again=again,
        configuration=shown if configuration else "",
    )


def folded(sheet: Sheet) -> str:
    """Return one sheet under its title, closed until it is asked for; a printer gets it open."""
    heading, _, rest = table_html(sheet).partition("\n")
    return f"<details>\n<summary>{heading}</summary>\n{rest}</details>"


def table_html(sheet: Sheet) -> str:
    """Return one sheet as a heading, a table and its notes."""
    headers = "".join(
        f'<th{_class("published" if header in BESIDE else "")} scope="col">{escape(header)}</th>'
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
