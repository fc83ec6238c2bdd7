"""An indicator from run to run: the mean over the conditions, and each condition behind it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.report.pictures.conditions import BLUE, INK, RED, own_settings
from hjcamp.report.pictures.dot_plot import TITLES
from hjcamp.report.pictures.drawing import dress
from hjcamp.storage import whole_file

MOST_LABELS = 24
LONGEST_LABEL = 18


def draw_history(path: Path, title: str, indicator: str, rows: Sequence[Mapping[str, Any]], labels: Sequence[str]) -> None:
    """Write the picture of the ``rows`` of a history; a red mark is a row in which conditions changed."""
    from matplotlib.figure import Figure

    places = list(range(len(rows)))
    with own_settings():
        figure = Figure(figsize=(8.4, 3.6), layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
        axes = figure.subplots()
        dress(axes, TITLES.get(indicator, indicator))
        for name in rows[0]["conditions"]:
            axes.plot(places, [row["conditions"][name]["mean"] for row in rows], color=INK, linewidth=0.6, alpha=0.3)
        axes.errorbar(
            places, [row["mean"] for row in rows], yerr=[row["standard_error"] or 0.0 for row in rows], color=BLUE,
            marker="o", markersize=4.5, linewidth=1.4, label="mean over the conditions",
        )  # fmt: skip
        changed = [place for place in places if rows[place]["changed"]]
        if changed:
            axes.plot(
                changed, [rows[place]["mean"] for place in changed], "o", color=RED, markersize=6, zorder=5,
                label="conditions changed",
            )  # fmt: skip
        every = max(1, -(-len(rows) // MOST_LABELS))
        shown = [text[:LONGEST_LABEL] for text in labels]
        axes.set_xticks(places[::every], shown[::every], rotation=40, ha="right", fontsize=7.5)
        axes.legend(fontsize=8, frameon=False)
        with whole_file(path) as stream:
            figure.savefig(stream, dpi=150, format=path.suffix[1:].lower())
