"""The error of a model from round to round of a hunt, over the time that the rig was at work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.report.pictures.conditions import BLUE, INK, RED
from hjcamp.report.pictures.drawing import draw, dress

LINES = (("baseline", RED, "calibrated"), ("augmented", BLUE, "with what was found"))


def draw_rounds(rounds: Sequence[tuple[float, Mapping[str, float | None]]]) -> str:
    """Return the SVG of errors over the noise floor, ``baseline`` and ``augmented``, at the minutes of each round."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        dress(axis, "Error over noise floor")
        for key, colour, label in LINES:
            points = [(minutes, value) for minutes, error in rounds if (value := error.get(key)) is not None and value > 0.0]
            if points:
                axis.plot(*zip(*points, strict=True), "o-", color=colour, markersize=4.5, linewidth=1.4, label=label)
        axis.axhline(1.0, color=INK, linewidth=0.8, linestyle="--", label="noise floor")
        axis.set_yscale("log")
        axis.yaxis.set_major_formatter(lambda value, place: f"{value:g}")
        axis.yaxis.set_minor_formatter(lambda value, place: f"{value:g}" if str(value)[0] in "25" else "")
        axis.set_xlim(left=0.0)
        axis.set_xlabel("time of the rig (min)")
        axis.legend(fontsize=8, frameon=False)

    return draw((7.0, 3.0), "hunt", paint)
