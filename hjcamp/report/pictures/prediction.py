"""Pictures of a prediction-error analysis: the worst windows, and models side by side."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import INK, MODELS
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.wording.units import unit_for

Array = NDArray[np.float64]
FARTHEST = 3.0


def readable(name: str, unit: str, *values: Array) -> tuple[str, list[Array]]:
    """Return a label with its unit, and the values in it: that of tables, in which the largest of them is read."""
    seen = [np.abs(one[np.isfinite(one)]) for one in map(np.asarray, values)]
    called, factor = unit_for(max((float(one.max(initial=0.0)) for one in seen), default=0.0), unit)
    return f"{name} ({called})" if called else name, [np.asarray(one) * factor for one in values]


def draw_windows(
    name: str,
    unit: str,
    time: Array,
    measured: Array,
    models: Sequence[tuple[str, Array]],
    edges: Array,
    *,
    observed: str = "measured",
) -> str:
    """Return a stretch of one channel: measured and predicted above, residuals below; gaps at the windows' ``edges``."""
    colours = itertools.cycle(itertools.product(("-", "--", ":"), MODELS))
    # of a model that diverges no more is drawn than shows what was measured
    most = FARTHEST * float(np.ptp(measured)) or np.inf
    left_over = [np.clip(values - measured, -most, most) for _, values in models]
    label, scaled = readable(name, unit, measured, *(measured + one for one in left_over))
    residual, [_, *left] = readable(f"model - {observed}", unit, measured, *left_over)

    def paint(figure: Any) -> None:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        above.plot(time, scaled[0], color=INK, linewidth=1.0, label=observed)
        inside = edges[(edges > 0) & (edges < len(time))]
        for (called, _), values, error, (line, colour) in zip(models, scaled[1:], left, colours, strict=False):
            values[inside - 1] = error[inside - 1] = np.nan
            above.plot(time, values, line, color=colour, linewidth=1.0, label=called)
            below.plot(time, error, line, color=colour, linewidth=0.9)
        below.axhline(0.0, color=INK, linewidth=0.6)
        above.legend(fontsize=8, frameon=False, ncols=4)
        dress(above, label)
        dress(below, residual)
        below.set_xlabel("time (s)", color=INK, fontsize=8.5)

    return draw((9.6, 4.2), "windows", paint)


def draw_model_bars(quantity: str, unit: str, rows: Sequence[tuple[str, float]], noise_floor: float) -> str:
    """Return the error of each model in a channel as bars in the models' colours, and its noise floor as a line."""
    label, [bars, line] = readable(quantity, unit, np.array([value for _, value in rows]), np.array([noise_floor]))

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        names = [name for name, _ in rows][::-1]
        colours = list(itertools.islice(itertools.cycle(MODELS), len(rows)))
        drawn = axis.barh(names, np.where(np.isfinite(bars), bars, 0.0)[::-1], color=colours[::-1], height=0.6)
        axis.bar_label(drawn, ["" if np.isfinite(one) else "diverges" for one in bars[::-1]], padding=6, fontsize=8, color=INK)
        axis.axvline(line[0], color=INK, linewidth=0.9, linestyle="--")
        axis.text(line[0], len(rows) - 0.45, " noise floor", fontsize=8, color=INK)
        dress(axis, "")
        axis.set_xlabel(label, color=INK, fontsize=8.5)

    return draw((9.6, 0.5 * len(rows) + 1.0), "models", paint)
