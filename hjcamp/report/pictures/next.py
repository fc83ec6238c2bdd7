"""The picture of proposed tests: what each rival predicts for them, with the rig's scatter, and how far they separate."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, GREEN, INK, RED, own_settings
from hjcamp.report.pictures.drawing import dress

Array = NDArray[np.float64]
COLOURS = (BLUE, RED, GREEN, "#cc79a7")
FARTHEST = 30.0
HEIGHT = 8.0
COLUMNS = 4
SEEN = 3.0


class Prediction(NamedTuple):
    """One test: time (n,), and the mean of each rival (n, rows) with the standard deviation of its repetitions or draws."""

    title: str
    time: Array
    means: Mapping[str, Array]
    spreads: Mapping[str, Array]


class Labels(NamedTuple):
    """What the rows of the picture are, the last one's difference from the first rival ``{name}`` and its factor, the bands."""

    rows: Sequence[str]
    last: str
    factor: float = 1e3
    bands: str = "2 standard deviations of the repetitions"


class Bar(NamedTuple):
    """One pair of rivals, or one effect: its separation by all tests together, and by each test alone."""

    name: str
    together: float
    alone: Sequence[float]


def draw_predictions(tests: Sequence[Prediction], bars: Sequence[Bar], labels: Labels) -> bytes:
    """Return the picture as PNG: a column for each test (at most four), and bars of separations below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    buffer = io.BytesIO()
    with own_settings():
        FigureCanvasAgg(predictions_figure(tests, bars, labels, Figure)).print_png(buffer)
    return buffer.getvalue()


def predictions_figure(tests: Sequence[Prediction], bars: Sequence[Bar], labels: Labels, kind: Callable[..., Any]) -> Any:
    """Return the picture as a figure of matplotlib, made by ``kind``."""
    shown = list(tests)[:COLUMNS]
    below = 1.0 + 0.24 * len(bars)
    with own_settings():
        figure = kind(figsize=(1.4 + 4.0 * max(len(shown), 2), HEIGHT + below), layout="constrained")
        top, bottom = np.ravel(np.asarray(figure.subfigures(2, 1, height_ratios=[HEIGHT, below])))
        axes = top.subplots(len(labels.rows) + 1, len(shown), squeeze=False, sharex="col")
        similar = len({tuple(one.means) for one in shown}) == 1
        for column, one in enumerate(shown):
            _column(axes[:, column], one, f"{column + 1}  {one.title}", column == 0, labels)
            if not similar:
                axes[0, column].legend(fontsize=7.5, frameon=False, loc="best")
        if similar:
            handles, names = axes[0, 0].get_legend_handles_labels()
            top.legend(handles, names, fontsize=8, frameon=False, ncols=len(names), loc="outside upper right")
        _bars(bottom.subplots(), bars, labels.bands)
    return figure


def _column(axes: Any, one: Prediction, title: str, labelled: bool, labels: Labels) -> None:
    first = next(iter(one.means))
    curves = {
        name: np.column_stack([mean, labels.factor * (mean - one.means[first])[:, -1]]) for name, mean in one.means.items()
    }
    spreads = {name: np.column_stack([spread, labels.factor * spread[:, -1]]) for name, spread in one.spreads.items()}
    for row, (axis, label) in enumerate(zip(axes, (*labels.rows, labels.last.format(name=first)), strict=True)):
        for number, (name, curve) in enumerate(curves.items()):
            colour = COLOURS[number % len(COLOURS)]
            if number == 0 or row < len(labels.rows):
                band = 2 * spreads[name][:, row]
                low, high = curve[:, row] - band, curve[:, row] + band
                axis.fill_between(one.time, low, high, color=colour, alpha=0.18, linewidth=0)
            style = "-" if number == 0 else (0, (5, 1.5 + number))
            axis.plot(one.time, curve[:, row], color=colour, linewidth=1.2, linestyle=style, label=name)
        dress(axis, label if labelled or row == len(labels.rows) else "")
    _limit(axes[-1], curves, spreads[first])
    axes[0].set_title(title, loc="left", fontsize=9, color=INK)
    axes[-1].set_xlabel("Time (s)", color=INK, fontsize=8.5)


def _limit(axis: Any, curves: Mapping[str, Array], spread: Array) -> None:
    """Leave the few samples around a slip out of the scale: its instant is nobody's to predict."""
    values = np.concatenate([np.abs(curve[:, -1]) for curve in curves.values()] + [2 * spread[:, -1]])
    most = 1.3 * max(float(np.quantile(values, 0.97)), 1e-12)
    axis.set_ylim(-most, most)


def _bars(axis: Any, bars: Sequence[Bar], bands: str) -> None:
    rows = list(bars)[::-1]
    axis.barh(range(len(rows)), [bar.together for bar in rows], color=BLUE, height=0.6, alpha=0.55)
    most = min(FARTHEST, 1.1 * max([SEEN, *(value for bar in rows for value in (bar.together, *bar.alone))]))
    for place, bar in enumerate(rows):
        for number, value in enumerate(bar.alone, start=1):
            where = min(value, 0.99 * most)
            axis.text(where, place, str(number), fontsize=7.5, color=INK, ha="center", va="center", clip_on=True)
        if bar.together > most:
            axis.text(0.97 * most, place, f"{bar.together:.0f} >", fontsize=7.5, color=INK, ha="right", va="center")
    axis.set_yticks(range(len(rows)), [bar.name for bar in rows], fontsize=8)
    axis.set_ylim(-0.8, max(len(rows) - 0.2, 1.8))
    axis.set_xlim(0.0, most)
    axis.axvline(SEEN, color=INK, linewidth=1.0, linestyle=(0, (4, 2.5)))
    dress(axis, "")
    axis.grid(False, axis="y")
    text = (
        "Expected separation after refitting, in standard deviations: bar all tests, number one test alone, dashed 3.\n"
        f"Bands above: {bands}."
    )
    axis.set_xlabel(text, color=INK, fontsize=8.5)
