"""Figures for a text: the means of all conditions and the course of each, at a given width, as pdf, svg or pgf."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from hjcamp.errors import UsageError, unknown
from hjcamp.report.pictures.conditions import BLUE, GRID, INK, RED, own_settings
from hjcamp.report.pictures.dot_plot import Dots
from hjcamp.report.runs.followed import ERROR, FOLLOWED, UNIT, WANTED
from hjcamp.report.runs.spread import Condition
from hjcamp.report.wording.names import readable
from hjcamp.report.wording.units import label
from hjcamp.storage import whole_file

FORMATS = ("pdf", "svg", "pgf")
#: Name of the figure of all means.
MEANS = "means"
#: What measures the text of a pgf figure.
LATEX = "pdflatex"
NARROWEST_MM, WIDEST_MM = 40.0, 400.0
MM = 1.0 / 25.4
TITLES = {
    "rmse1_deg": "RMSE1 (deg)",
    "rmse2_deg": "RMSE2 (deg)",
    "e_max_deg": "largest error (deg)",
    "sse_deg": "SSE (deg)",
}


HALF_A_PAGE_MM = 100.0


class Style(NamedTuple):
    """Width of a column (mm), size of letters (points) and family of a kind of text."""

    width_mm: float
    size: float
    family: str
    document: str = "article"

    @property
    def text_mm(self) -> float:
        """Width of the text: of two columns where one is narrow."""
        return self.width_mm if self.width_mm > HALF_A_PAGE_MM else 2.0 * self.width_mm


STYLES = {
    "plain": Style(150.0, 9.0, "sans-serif"),
    "ieee": Style(88.9, 8.0, "serif", "IEEEtran"),
    "elsevier": Style(90.0, 8.0, "sans-serif", "elsarticle"),
    # its classes are in no distribution of TeX: a page with one would not be set where that is not fetched
    "springer": Style(84.0, 8.0, "sans-serif"),
    "thesis": Style(145.0, 10.0, "serif"),
}


def style_of(name: str, width_mm: float | None) -> Style:
    """Return a known style at another width where one is given; `UsageError` for an unknown name and a width that cannot be."""
    if name not in STYLES:
        raise unknown("figure style", name, STYLES, "--style")
    style = STYLES[name]
    if width_mm is None:
        return style
    if not NARROWEST_MM <= width_mm <= WIDEST_MM:
        raise UsageError(f"--width {width_mm:g}: give {NARROWEST_MM:g} to {WIDEST_MM:g} mm")
    return style._replace(width_mm=width_mm)


def formats_of(asked: str | None) -> list[str]:
    """Return the formats of a list with commas; all that can be made here where none is asked for."""
    can = [name for name in FORMATS if name != "pgf" or shutil.which(LATEX)]
    names = [name.strip() for name in (asked or "").split(",") if name.strip()]
    for name in names:
        if name not in FORMATS:
            raise unknown("figure format", name, FORMATS, "--formats")
        if name not in can:
            raise UsageError(f"--formats {name}: {LATEX} is needed to measure the text; without it: {','.join(can)}")
    if asked is not None and not names:
        raise UsageError(f"--formats: name at least one of {', '.join(FORMATS)}")
    return list(dict.fromkeys(names)) or can


def write_figure(
    folder: Path, name: str, formats: Sequence[str], style: Style, height: float, paint: Callable[[Any], None]
) -> None:
    """Write one figure, FOLDER/NAME.FORMAT in each format, ``height`` as a share of its width; equal content gives equal files."""
    from matplotlib.figure import Figure

    settings: dict[str, Any] = {
        "font.size": style.size, "font.family": style.family, "axes.labelsize": style.size, "axes.linewidth": 0.6,
        "xtick.labelsize": style.size - 1.0, "ytick.labelsize": style.size - 1.0, "legend.fontsize": style.size - 1.0,
        "axes.spines.top": False, "axes.spines.right": False, "axes.unicode_minus": False, "pdf.fonttype": 42,
        "svg.fonttype": "none", "svg.hashsalt": name, "pgf.texsystem": LATEX, "pgf.rcfonts": False, "lines.linewidth": 1.0,
        "axes.edgecolor": INK, "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
    }  # fmt: skip
    # A pgf has no metadata, and takes no word about them.
    undated: dict[str, dict[str, Any]] = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}
    with own_settings(settings):
        figure = Figure(figsize=(style.width_mm * MM, style.width_mm * MM * height), layout="constrained")
        paint(figure)
        for kind in formats:
            with whole_file(folder / f"{name}.{kind}") as stream:
                words: dict[str, Any] = {"metadata": undated[kind]} if kind in undated else {}
                figure.savefig(stream, format=kind, **words)


def drawn(name: str) -> str:
    """Return the name of a condition as a figure shows it: a pgf figure is read by LaTeX."""
    return re.sub(r"[\\{}^~%#&$]", " ", readable(name))


def means_painter(conditions: Sequence[str], indicators: Sequence[str], kinds: Sequence[Dots]) -> Callable[[Any], None]:
    """Return what paints mean and deviation of every condition, two panels next to each other."""

    def paint(figure: Any) -> None:
        columns = min(2, len(indicators))
        panels = figure.subplots(-(-len(indicators) // columns), columns, sharey=True, squeeze=False)
        for panel in panels.flat[len(indicators) :]:
            panel.set_visible(False)
        for panel, indicator in zip(panels.flat, indicators, strict=False):
            for number, kind in enumerate(kinds):
                points = [
                    (place + 0.15 * (2 * number - len(kinds) + 1), *kind.values[name, indicator])
                    for place, name in enumerate(conditions)
                    if (name, indicator) in kind.values
                ]
                if points:
                    places, means, deviations = zip(*points, strict=True)
                    panel.errorbar(
                        means, places, xerr=[one or 0.0 for one in deviations], fmt="oDs^"[number % 4], markersize=3.0,
                        color=(BLUE, INK, RED)[number % 3], markerfacecolor="none" if number else None, elinewidth=0.8,
                        label=kind.name,
                    )  # fmt: skip
            panel.set_xlabel(TITLES.get(indicator, readable(indicator)))
            panel.grid(True, axis="x", color=GRID, linewidth=0.4)
            panel.set_axisbelow(True)
        panels[0, 0].set_yticks(range(len(conditions)), [drawn(name) for name in conditions])
        panels[0, 0].set_ylim(len(conditions) - 0.4, -0.6)
        if len(kinds) > 1:
            figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=len(kinds), frameon=False)

    return paint


def means_caption(indicators: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    """Return what the figure of means shows, and of how many tests."""
    numbers = sorted({int(row["n"]) for row in rows})
    tests = f"n = {numbers[0]}" if len(numbers) == 1 else f"n = {numbers[0]} to {numbers[-1]}"
    shown = ", ".join(TITLES.get(name, readable(name)).removesuffix(" (deg)") for name in indicators)
    return (
        f"{shown} of every condition: mean and sample standard deviation of the tests ({tests}), with published values if any."
    )


def course_caption(condition: Condition) -> str:
    """Return what the course of a condition shows: of how many tests, and whether a mean or one of them is drawn."""
    tests = f"n = {condition.tests}"
    if condition.tests < 2:
        return f"{readable(condition.name)}: reference, {label(FOLLOWED)} and error of one test."
    if condition.aligned:
        return f"{readable(condition.name)}: reference, {label(FOLLOWED)} and error, mean and range of the tests ({tests})."
    return (
        f"{readable(condition.name)}: reference, {label(FOLLOWED)} and error, one test in bold, others thin, range of all ({tests}); "
        "the tests do not move in phase, so no mean is drawn."
    )


def course_painter(condition: Condition) -> Callable[[Any], None]:
    """Return what paints reference, mean (one repetition where they do not align) and range of what follows it, and the error below."""

    def paint(figure: Any) -> None:
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
        for panel, signal, text in ((top, FOLLOWED, f"{label(FOLLOWED)} ({UNIT})"), (bottom, ERROR, f"error ({UNIT})")):
            spread = condition.signals[signal]
            bold, others = condition.lines(signal)
            for number, one in enumerate(others):
                thin = {"label": f"{len(others)} others"} if number == 0 else {}
                panel.plot(condition.time, one, color=BLUE, linewidth=0.35, alpha=0.6, **thin)
            panel.plot(condition.time, bold, color=BLUE, label="one repetition" if others else "mean")
            if condition.tests > 1:
                panel.fill_between(
                    condition.time, spread.lowest, spread.highest, color=BLUE, alpha=0.25, linewidth=0.0, label="range"
                )
            panel.set_ylabel(text)
        top.plot(condition.time, condition.signals[WANTED].mean, "--", color=INK, linewidth=0.8, label="reference")
        top.legend(frameon=False)
        bottom.set_xlabel("time (s)")

    return paint


def drawable(condition: Condition) -> bool:
    """Return whether a condition has the signals of `course_painter`."""
    signals: Mapping[str, Any] = condition.signals
    return {FOLLOWED, ERROR, WANTED} <= set(signals) and bool(len(condition.time))
