"""Pictures of the difference between model and measurement of the joint: overlay, residual map, error against horizon."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.names import readable
from hjcamp.report.pictures.conditions import BLUE, GRID, INK, MODELS
from hjcamp.report.pictures.drawing import draw, dress

Array = NDArray[np.float64]
LABELS = ("Arm angle (deg)", "Pressure 1 (MPa)", "Pressure 2 (MPa)")
CELLS = 14
FEWEST = 4
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


def draw_map(velocity: Array, arm: Array, force: Array, bars: Sequence[tuple[str, str, float]]) -> str:
    """Return the mean missing force (N) over speed (mm/s) and arm angle (deg), and bars (group, label, share)."""

    def paint(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.3, 1.0])
        _map(figure, left, velocity, arm, force)
        _bars(right, bars)

    return draw((9.6, 4.2), "where", paint)


def _bars(axis: Any, bars: Sequence[tuple[str, str, float]]) -> None:
    """Draw bars from the top, each group under its name: every group divides the same error anew."""
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
    axis.set_title("each group divides the same error anew", loc="left", fontsize=8, color=INK)
    axis.set_xlabel("Share of the excess error (%)", color=INK, fontsize=8.5)


def _map(figure: Any, axis: Any, velocity: Array, arm: Array, force: Array) -> None:
    if len(velocity) < FEWEST or np.ptp(arm) == 0.0:
        # without axes: an empty grid looks like a result
        axis.set_axis_off()
        axis.text(0.5, 0.5, NO_MAP, ha="center", transform=axis.transAxes, fontsize=8, color=INK)
        return
    dress(axis, "Arm angle (deg)")
    axis.set_xlabel("Speed of the sliders (mm/s)", color=INK, fontsize=8.5)
    limit = float(np.quantile(np.abs(velocity), 0.98))
    edges = np.linspace(-limit, limit, CELLS + 1), np.linspace(arm.min(), arm.max(), CELLS + 1)
    number = np.histogram2d(velocity, arm, bins=edges)[0]
    total = np.histogram2d(velocity, arm, bins=edges, weights=force)[0]
    mean = np.ma.masked_where(number < FEWEST, total / np.maximum(number, 1))
    most = max(float(np.abs(mean).max()) if mean.count() else 0.0, 1e-9)
    mesh = axis.pcolormesh(*edges, mean.T, cmap="RdBu_r", vmin=-most, vmax=most)
    bar = figure.colorbar(mesh, ax=axis)
    bar.set_label("Missing force (N)", fontsize=8)
    bar.ax.tick_params(labelsize=7)


def draw_horizon(curves: Sequence[HorizonCurve], floor: Array | None) -> str:
    """Return the error of the arm (deg) and its floor (rad, (k,)) against the time since a restart (ms)."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        for number, one in enumerate(curves):
            colour = MODELS[number % len(MODELS)]
            axis.plot(one.time * 1e3, np.degrees(one.rms), color=colour, linewidth=1.4, label=one.name)
        if floor is not None:
            style = (0, (4, 2.5))
            axis.plot(curves[0].time * 1e3, np.degrees(floor), color=INK, linewidth=1.0, linestyle=style, label="floor")
        dress(axis, "Error of the arm (deg, rms)")
        axis.set_xlabel("Time since the restart from measured states (ms)", color=INK, fontsize=8.5)
        axis.legend(fontsize=8, frameon=False)

    return draw((7.4, 3.4), "horizon", paint)
