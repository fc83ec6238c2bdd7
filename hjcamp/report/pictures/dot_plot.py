"""One picture of a whole run: a row for each condition, a panel for each indicator, means with deviations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from hjcamp.report.pictures.conditions import BLUE, GRID, INK, RED
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.wording.names import readable

MOST_ROWS = 60
ROW, FRAME = 0.24, 1.0
TITLES = {"rmse1_deg": "RMSE1 (deg)", "rmse2_deg": "RMSE2 (deg)", "e_max_deg": "|e|max (deg)", "sse_deg": "SSE (deg)"}
MARKS = ("o", "D", "s", "^")


class Dots(NamedTuple):
    """One kind of dots: its name, and mean and deviation by condition and indicator."""

    name: str
    values: Mapping[tuple[str, str], tuple[float, float | None]]


def dots_of(rows: Sequence[Mapping[str, Any]], name: str, indicators: Sequence[str], part: str = "") -> Dots:
    """Return the means and deviations of rows of `by_condition`; ``part`` is "_published" for the published ones."""
    values = {}
    for row in rows:
        for indicator in indicators:
            mean = row.get(f"{indicator}{part}_mean")
            if mean is not None:
                values[str(row["condition"]), indicator] = (float(mean), row.get(f"{indicator}{part}_std"))
    return Dots(name, values)


def draw_dots(conditions: Sequence[str], indicators: Sequence[str], kinds: Sequence[Dots]) -> str:
    """Return the picture as SVG text; the first ``MOST_ROWS`` conditions, from the top."""
    shown = list(conditions)[:MOST_ROWS]
    colours = (BLUE, INK, RED)

    def paint(figure: Any) -> None:
        panels = figure.subplots(1, len(indicators), sharey=True, squeeze=False)[0]
        for panel, indicator in zip(panels, indicators, strict=True):
            for number, kind in enumerate(kinds):
                offset = 0.14 * (2 * number - len(kinds) + 1)
                there = [
                    (row + offset, *kind.values[name, indicator])
                    for row, name in enumerate(shown)
                    if (name, indicator) in kind.values
                ]
                if there:
                    rows, means, deviations = zip(*there, strict=True)
                    panel.errorbar(
                        means, rows, xerr=[one or 0.0 for one in deviations], fmt=MARKS[number % len(MARKS)], markersize=4.5,
                        color=colours[number % len(colours)], elinewidth=1.1, markerfacecolor="none" if number else colours[0],
                        label=kind.name,
                    )  # fmt: skip
            dress(panel, "")
            panel.grid(False, axis="y")
            panel.grid(True, axis="x", color=GRID, linewidth=0.5)
            panel.set_xlabel(TITLES.get(indicator, indicator), color=INK, fontsize=8.5)
            if not any(value < 0 for kind in kinds for (_, one), (value, _) in kind.values.items() if one == indicator):
                # the margin is of the axis from 0 on: values that lie close together would be cut at its end
                panel.set_xlim(0.0, 1.05 * panel.dataLim.x1 if panel.dataLim.x1 > 0.0 else None)
        panels[0].set_yticks(range(len(shown)), [readable(name) for name in shown], fontsize=7.5)
        panels[0].set_ylim(len(shown) - 0.4, -0.6)
        handles, labels = panels[0].get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside upper left", ncols=len(kinds), fontsize=8, frameon=False)

    return draw((9.6, FRAME + ROW * max(len(shown), 2)), "conditions", paint)
