"""Draw the charts of an identification (the figures of chapter 4) and the page that holds them."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, Protocol

from hjcamp.report.pages.page import SHADES
from hjcamp.report.pages.template import page_of
from hjcamp.report.pictures.conditions import BLUE, GREEN, GRID, INK, RED, SETTINGS, own_settings, tidy

COLOURS = (BLUE, RED, GREEN, INK)
SIZE = (7.4, 3.4)
HEADINGS = ("constant", "value", "95 % interval", "published", "tests")
STYLES: dict[str, dict[str, Any]] = {
    "line": {"linewidth": 1.2},
    "dashed": {"linewidth": 1.4, "linestyle": (0, (4, 2.5))},
    "faint": {"linewidth": 0.7, "alpha": 0.5},
    "points": {"linestyle": "none", "marker": "o", "markersize": 3.5, "markeredgewidth": 0.0},
}


class ChartLike(Protocol):
    """A chart as data; ``figure`` is the figure of the thesis that it repeats.

    ``series`` are curves with x and y (n,), label, style (line, dashed, faint, points) and the number of their colour.
    """

    @property
    def name(self) -> str: ...
    @property
    def figure(self) -> str: ...
    @property
    def caption(self) -> str: ...
    @property
    def x_label(self) -> str: ...
    @property
    def y_label(self) -> str: ...
    @property
    def series(self) -> Sequence[Any]: ...
    @property
    def logarithmic(self) -> bool: ...
    @property
    def logarithmic_x(self) -> bool: ...


def draw_chart(chart: ChartLike) -> str:
    """Return a chart as SVG text."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with own_settings(SETTINGS | {"svg.hashsalt": chart.name}):
        figure = Figure(figsize=SIZE, layout="tight")
        figure.patch.set_visible(False)
        axes = figure.add_subplot()
        for one in chart.series:
            colour = COLOURS[one.colour % len(COLOURS)]
            axes.plot(one.x, one.y, color=colour, label=one.label or None, **STYLES[one.style])
        if chart.logarithmic:
            axes.set_yscale("log")
        if chart.logarithmic_x:
            axes.set_xscale("log")
        axes.set_xlabel(chart.x_label, color=INK, fontsize=8.5)
        axes.set_ylabel(chart.y_label, color=INK, fontsize=8.5)
        axes.grid(True, axis="y", color=GRID, linewidth=0.5)
        axes.patch.set_visible(False)
        axes.tick_params(colors=INK, labelsize=8, width=0.7, length=3)
        for side, spine in axes.spines.items():
            spine.set_visible(side in ("left", "bottom"))
            spine.set_color(INK)
        if any(one.label for one in chart.series):
            axes.legend(fontsize=8, frameon=False, labelcolor=INK, handlelength=1.8)
        buffer = io.StringIO()
        nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
        FigureCanvasSVG(figure).print_svg(buffer, metadata=nothing)
    return tidy(buffer.getvalue())


def title_of(chart: ChartLike, subject: str = "") -> str:
    """Return the heading of a chart: what it shows and the figure of the thesis that it repeats."""
    place = f" ({subject})" if subject else ""
    return f"{chart.caption}{place}, as Figure {chart.figure}"


def identification_page(
    title: str, facts: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str], charts: Sequence[ChartLike]
) -> str:
    """Return one self-contained HTML page: the table of estimates, notes and warnings, and every chart."""
    table = "\n".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    drawn = [(escape(title_of(one)), shaded(draw_chart(one))) for one in charts]
    pictures = "\n".join(f"<h3>{heading}</h3>\n<figure>{svg}</figure>" for heading, svg in drawn)
    head = "".join(f'<th scope="col">{name}</th>' for name in HEADINGS)
    listed = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return page_of(
        title,
        f'<h1>{escape(title)}</h1>\n<p class="soft">{escape(" · ".join(facts))}</p>\n<div class="scroll"><table>\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{table}\n</tbody></table></div>\n"
        f'<ul class="notes">{listed}</ul>\n{pictures}',
    )


def shaded(svg: str, shades: Mapping[str, str] = SHADES) -> str:
    """Return a drawing whose colours follow the page's light and dark."""
    for colour, shade in shades.items():
        svg = svg.replace(colour, shade)
    return svg
