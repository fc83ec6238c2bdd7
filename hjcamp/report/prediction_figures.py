"""Pictures of a prediction-error analysis: what is missing over its driver, chance, the worst windows, models side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.discrepancy_figures import draw, dress
from hjcamp.report.figures import BLUE, GREEN, INK, RED

Array = NDArray[np.float64]


def draw_curves(curves: Sequence[tuple[str, str, str, Mapping[str, Any]]]) -> str:
    """Return free laws with their 95 % bands, one panel each: title, label of the driver, label of the quantity, curve."""

    def paint(figure: Any) -> None:
        for place, (title, across, up, curve) in enumerate(curves):
            axis = figure.add_subplot(1, len(curves), place + 1)
            axis.fill_between(curve["x"], curve["low"], curve["high"], color=BLUE, alpha=0.2, linewidth=0)
            axis.plot(curve["x"], curve["y"], color=BLUE, linewidth=1.4)
            axis.axhline(0.0, color=INK, linewidth=0.6)
            dress(axis, up)
            axis.set_xlabel(across, color=INK, fontsize=8.5)
            axis.set_title(title, color=INK, fontsize=9, loc="left")

    return draw((4.8 * len(curves), 3.2), "missing", paint)


def draw_chance(chance: Array, gain: float) -> str:
    """Return the largest gains beside residuals moved in time as a strip, and the real one."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        spread = np.random.default_rng(1).uniform(-0.3, 0.3, len(chance))
        axis.plot(chance, spread, ".", color=INK, markersize=3, alpha=0.5, label="residuals moved in time")
        axis.plot([gain], [0.0], "D", color=RED, markersize=7, label="these tests")
        axis.set_yticks([])
        axis.set_ylim(-1.0, 1.0)
        dress(axis, "")
        axis.set_xlabel("largest gain of the library (log-likelihood)", color=INK, fontsize=8.5)
        axis.legend(fontsize=8, frameon=False, loc="upper center", ncols=2)

    return draw((9.6, 1.7), "chance", paint)


def draw_windows(
    label: str, time: Array, measured: Array, models: Sequence[tuple[str, Array]], period: float, edges: Array
) -> str:
    """Return a stretch of one channel: measured and predicted above, residuals below; gaps at the windows' ``edges``."""
    colours = (RED, GREEN, BLUE, INK)

    def paint(figure: Any) -> None:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        above.plot(time, measured, color=INK, linewidth=1.0, label="measured")
        for (name, values), colour in zip(models, colours, strict=False):
            shown, left = values.copy(), measured - values
            inside = edges[(edges > 0) & (edges < len(time))]
            shown[inside - 1] = np.nan
            left[inside - 1] = np.nan
            above.plot(time, shown, color=colour, linewidth=1.0, label=name)
            below.plot(time, left, color=colour, linewidth=0.9)
        below.axhline(0.0, color=INK, linewidth=0.6)
        above.legend(fontsize=8, frameon=False, ncols=4)
        dress(above, label)
        dress(below, "residual")
        below.set_xlabel(f"time (s), one sample each {period:.4g} s", color=INK, fontsize=8.5)

    return draw((9.6, 4.2), "windows", paint)


def draw_model_bars(unit: str, rows: Sequence[tuple[str, float]], floor: float) -> str:
    """Return the error of each model in a channel as bars, and its floor as a line."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        names = [name for name, _ in rows][::-1]
        axis.barh(names, [value for _, value in rows][::-1], color=BLUE, height=0.6)
        axis.axvline(floor, color=INK, linewidth=0.9, linestyle="--")
        axis.text(floor, len(rows) - 0.45, " floor", fontsize=8, color=INK)
        dress(axis, "")
        axis.set_xlabel(unit, color=INK, fontsize=8.5)

    return draw((9.6, 0.5 * len(rows) + 1.0), "models", paint)
