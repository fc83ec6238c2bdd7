"""Pictures of the difference between model and measurement of the joint: overlay, residual map, error against horizon."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, GRID, INK, MODELS
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.wording.names import readable

Array = NDArray[np.float64]
LABELS = ("Arm angle (deg)", "Pressure 1 (MPa)", "Pressure 2 (MPa)")
CELLS = 14
FEWEST = 4
#: Standard errors above which a cell is shown in full, and how pale the others are.
CLEAR, PALE = 2.0, 0.25
NO_MAP = (
    "no map: the arm nowhere slides long and steadily enough\n"
    "to read a force off the pressures (it rests, is slow, or sticks and slips)"
)
ZOOM = 0.5


class Overlay(NamedTuple):
    """One test: time (n,), measured and each model's arm (deg) and pressures (MPa), (n, 3), and what readings are called."""

    name: str
    time: Array
    measured: Array
    models: Mapping[str, Array]
    observed: str = "measured"


class HorizonCurve(NamedTuple):
    """One model's error of the arm (rad) against the time since a restart (s), each (k,)."""

    name: str
    time: Array
    rms: Array


class Map(NamedTuple):
    """What is missing, ``values`` (n,), over two measured quantities (n,), the test of each, and their names with units."""

    x: Array
    y: Array
    values: Array
    of_test: NDArray[Any]
    x_label: str
    y_label: str
    label: str


def draw_overlay(one: Overlay) -> str:
    """Return measurement and models of one test over time, arm and pressures, and 0.5 s where the first model is worst."""

    def paint(figure: Any) -> None:
        axes = figure.subplots(3, 2, sharex="col", height_ratios=[1.4, 1.0, 1.0], width_ratios=[1.9, 1.0])
        part = worst_part(one)
        for column, (row, label) in enumerate(zip(axes, LABELS, strict=True)):
            for axis, inside in zip(row, (slice(None), part), strict=True):
                time = one.time[inside]
                axis.plot(time, one.measured[inside, column], color=INK, linewidth=1.6, alpha=0.55, label=one.observed)
                for number, (name, values) in enumerate(one.models.items()):
                    colour = MODELS[number % len(MODELS)]
                    axis.plot(time, values[inside, column], color=colour, linewidth=1.0, label=name)
                dress(axis, label if axis is row[0] else "")
            row[0].axvspan(one.time[part][0], one.time[part][-1], color=GRID, alpha=0.6, linewidth=0.0)
        axes[0, 0].set_title(readable(one.name), loc="left", fontsize=9, color=INK)
        axes[0, 1].set_title(f"the {ZOOM:g} s shaded", loc="left", fontsize=9, color=INK)
        axes[0, 0].legend(loc="best", fontsize=8, frameon=False, ncols=2)
        for axis in axes[-1]:
            axis.set_xlabel("Time (s)", color=INK, fontsize=8.5)

    return draw((9.6, 6.0), f"overlay {one.name}", paint)


def worst_part(one: Overlay) -> slice:
    """Return the samples of the ``ZOOM`` seconds in which the first model's arm is furthest from the measured one."""
    if len(one.time) < 2:
        return slice(None)
    width = min(len(one.time), max(2, round(ZOOM / float(np.median(np.diff(one.time))))))
    error = (next(iter(one.models.values()))[:, 0] - one.measured[:, 0]) ** 2
    total = np.concatenate([[0.0], np.cumsum(error)])
    begin = int(np.argmax(total[width:] - total[:-width]))
    return slice(begin, begin + width)


def draw_map(one: Map, bars: Sequence[tuple[str, str, float]], most: float | None = None) -> str:
    """Return the mean of what is missing over two measured quantities, and bars (group, label, share).

    The colours end at ``most``, so that maps of one quantity on a page can be compared. Pale is what is no more than twice its
    standard error from test to test.
    """

    def paint(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.3, 1.0])
        _map(figure, left, one, most)
        _bars(right, bars)

    return draw((9.6, 4.2), "where", paint)


def cells_of(one: Map) -> tuple[tuple[Array, Array], Array, Array]:
    """Return the edges of the cells, the mean of each (x, y), NaN where there are too few, and its standard error from test to test."""
    limit = float(np.quantile(np.abs(one.x), 0.98))
    low = -limit if one.x.min() < 0.0 else float(one.x.min())
    edges = np.linspace(low, limit, CELLS + 1), np.linspace(one.y.min(), one.y.max(), CELLS + 1)
    tests = []
    for test in np.unique(one.of_test):
        inside = one.of_test == test
        number = np.histogram2d(one.x[inside], one.y[inside], bins=edges)[0]
        total = np.histogram2d(one.x[inside], one.y[inside], bins=edges, weights=one.values[inside])[0]
        tests.append((number, total))
    numbers, totals = (np.array(column) for column in zip(*tests, strict=True))
    number, total = numbers.sum(axis=0), totals.sum(axis=0)
    mean = np.where(number >= FEWEST, total / np.maximum(number, 1), np.nan)
    seen = np.sum(numbers > 0, axis=0)
    squares = np.sum(np.where(numbers > 0, totals / np.maximum(numbers, 1) - mean, 0.0) ** 2, axis=0)
    error = np.where(seen > 1, np.sqrt(squares / np.maximum(seen * (seen - 1), 1)), np.inf)
    return edges, mean, error


def _bars(axis: Any, bars: Sequence[tuple[str, str, float]]) -> None:
    """Draw bars from the top, each group under its name: every group divides the same error again."""
    place, group, places, names = 0.0, "", [], []
    for number, (new, label, share) in enumerate(bars):
        if new != group:
            place += 1.3 if number else 0.0
            axis.text(0.0, place, new, fontsize=7, color=INK, va="center", fontweight="bold")
            place, group = place + 0.9, new
        axis.barh(place, 100 * share, color=INK if not new else BLUE, height=0.6)
        places.append(place)
        names.append(label)
        place += 0.9
    axis.set_yticks(places, names, fontsize=7)
    axis.set_ylim(max(place, 9.0), -0.8)
    dress(axis, "")
    axis.grid(False, axis="y")
    axis.grid(True, axis="x", color=GRID, linewidth=0.5)
    axis.set_title("alternative breakdowns of the same error", loc="left", fontsize=8, color=INK)
    axis.set_xlabel("Share of the error above repeatability (%)", color=INK, fontsize=8.5)


def _map(figure: Any, axis: Any, one: Map, most: float | None) -> None:
    if len(one.x) < FEWEST or np.ptp(one.x) == 0.0 or np.ptp(one.y) == 0.0:
        # without axes: an empty grid looks like a result
        axis.set_axis_off()
        axis.text(0.5, 0.5, NO_MAP, ha="center", transform=axis.transAxes, fontsize=8, color=INK)
        return
    dress(axis, one.y_label)
    axis.set_xlabel(one.x_label, color=INK, fontsize=8.5)
    edges, mean, error = cells_of(one)
    end = most or largest(one)
    for inside, alpha in ((np.abs(mean) > CLEAR * error, 1.0), (np.abs(mean) <= CLEAR * error, PALE)):
        shown = np.ma.masked_where(~inside, mean)
        mesh = axis.pcolormesh(*edges, shown.T, cmap="RdBu_r", vmin=-end, vmax=end, alpha=alpha)
        if alpha == 1.0:
            bar = figure.colorbar(mesh, ax=axis)
            bar.set_label(one.label, fontsize=8)
            bar.ax.tick_params(labelsize=7)


def largest(one: Map) -> float:
    """Return the largest mean of a cell that is more than noise, of any cell where none is."""
    if len(one.x) < FEWEST or np.ptp(one.x) == 0.0 or np.ptp(one.y) == 0.0:
        return 1e-9
    _, mean, error = cells_of(one)
    clear = np.abs(mean[np.abs(mean) > CLEAR * error])
    found = clear if len(clear) else np.abs(mean[np.isfinite(mean)])
    return max(float(found.max(initial=0.0)), 1e-9)


def draw_horizon(curves: Sequence[HorizonCurve], noise_floor: Array | None) -> str:
    """Return the error of the arm (deg) and its noise floor (rad, (k,)) against the time since a restart (ms)."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        for number, one in enumerate(curves):
            colour = MODELS[number % len(MODELS)]
            axis.plot(one.time * 1e3, np.degrees(one.rms), color=colour, linewidth=1.4, label=one.name)
        if noise_floor is not None:
            style = (0, (4, 2.5))
            axis.plot(
                curves[0].time * 1e3, np.degrees(noise_floor), color=INK, linewidth=1.0, linestyle=style, label="noise floor"
            )
        dress(axis, "Error of the arm (deg, rms)")
        axis.set_xlabel("Time since the restart from measured states (ms)", color=INK, fontsize=8.5)
        axis.legend(fontsize=8, frameon=False)

    return draw((7.4, 3.4), "horizon", paint)
