"""Main effects: each indicator over the values of each axis, the mean over all else with its interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.report.pictures.conditions import BLUE, GRID, INK
from hjcamp.report.pictures.dot_plot import TITLES
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.wording.names import readable

if TYPE_CHECKING:
    from hjcamp.report.tables.factors import Factor
    from hjcamp.report.tables.welch import Sample

CAPTION = (
    "thick: the mean over all combinations of the other axes, with its 95 % interval; thin: each combination; "
    "lines that are not parallel: the axes interact"
)
MOST_THIN = 12


def draw_main_effects(factors: Sequence[Factor], samples: Mapping[str, Mapping[str, Sample]]) -> str:
    """Return a row of panels for each factor, a panel for each indicator, as SVG text."""

    def paint(figure: Any) -> None:
        panels = figure.subplots(len(factors), len(samples), squeeze=False)
        for row, factor in zip(panels, factors, strict=True):
            for panel, (indicator, known) in zip(row, samples.items(), strict=True):
                _paint(panel, factor, known)
                dress(panel, "")
                panel.grid(True, axis="y", color=GRID, linewidth=0.5)
                panel.set_ylabel(TITLES.get(indicator, indicator), color=INK, fontsize=8.5)

    return draw((2.6 * len(samples) + 0.4, 2.3 * len(factors)), "main effects", paint)


def _paint(panel: Any, factor: Factor, known: Mapping[str, Sample]) -> None:
    places = np.arange(len(factor.values))
    curves = [
        [known[by[value]].mean if by.get(value) in known else np.nan for value in factor.values]
        for by in factor.conditions.values()
    ]
    for curve in curves[:MOST_THIN] if len(curves) > 1 else ():
        panel.plot(places, curve, color=INK, linewidth=0.7, alpha=0.35)
    means, halves = zip(*(_mean(factor, value, known) for value in factor.values), strict=True)
    panel.errorbar(places, means, yerr=halves, color=BLUE, marker="o", markersize=4.5, linewidth=1.6, elinewidth=1.1, capsize=3)
    panel.set_xticks(places, [readable(value) for value in factor.values], fontsize=7.5, rotation=20 if len(places) > 3 else 0)
    panel.set_xlim(-0.3, len(places) - 0.7)


def _mean(factor: Factor, value: str, known: Mapping[str, Sample]) -> tuple[float, float]:
    """Return the mean of a value over all combinations, and half its 95 % interval (0 where there is none)."""
    from hjcamp.report.tables.welch import Sample, contrast

    there = [known[by[value]] for by in factor.conditions.values() if by.get(value) in known]
    if not there:
        return np.nan, 0.0
    mean, half, _ = contrast(there, [Sample(0.0, 0.0, 2)] * len(there))
    return mean, half or 0.0
