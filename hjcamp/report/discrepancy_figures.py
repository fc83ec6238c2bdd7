"""Pictures of the difference between model and measurement: overlay, residual map, error against horizon, bars."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.figures import BLUE, GREEN, GRID, INK, RED, SETTINGS

Array = NDArray[np.float64]
COLOURS = (RED, BLUE, GREEN)
LABELS = ("Arm angle (deg)", "Pressure 1 (MPa)", "Pressure 2 (MPa)")
CELLS = 14
FEWEST = 4


class Overlay(NamedTuple):
    """One test: time (n,), measured and each model's arm (deg) and pressures (MPa), (n, 3)."""

    name: str
    time: Array
    measured: Array
    models: Mapping[str, Array]


class HorizonCurve(NamedTuple):
    """One model's error of the arm (rad) and its floor against the time since a restart (s), each (k,)."""

    name: str
    time: Array
    rms: Array
    floor: Array | None


def draw(size: tuple[float, float], name: str, paint: Callable[[Any], None]) -> str:
    """Return the SVG text of a figure that ``paint`` fills; equal content gives equal text."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context(SETTINGS | {"svg.hashsalt": name}):  # type: ignore[arg-type]
        figure = Figure(figsize=size, layout="constrained")
        paint(figure)
        buffer = io.StringIO()
        nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
        FigureCanvasSVG(figure).print_svg(buffer, metadata=nothing)
    return buffer.getvalue()


def draw_overlay(one: Overlay) -> str:
    """Return measurement and models of one test over time, arm and both pressures."""

    def paint(figure: Any) -> None:
        axes = figure.subplots(3, 1, sharex=True, height_ratios=[1.4, 1.0, 1.0])
        for column, (axis, label) in enumerate(zip(axes, LABELS, strict=True)):
            axis.plot(one.time, one.measured[:, column], color=INK, linewidth=1.6, alpha=0.55, label="measured")
            for number, (name, values) in enumerate(one.models.items()):
                colour = COLOURS[number % len(COLOURS)]
                axis.plot(one.time, values[:, column], color=colour, linewidth=1.0, label=name)
            dress(axis, label)
        axes[0].set_title(one.name, loc="left", fontsize=9, color=INK)
        axes[0].legend(loc="best", fontsize=8, frameon=False, ncols=4)
        axes[-1].set_xlabel("Time (s)", color=INK, fontsize=8.5)

    return draw((7.4, 6.0), f"overlay {one.name}", paint)


def draw_map(velocity: Array, arm: Array, force: Array, rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the mean missing force (N) over speed (mm/s) and arm angle (deg), and bars of the largest shares."""

    def paint(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.3, 1.0])
        _map(figure, left, velocity, arm, force)
        shown = list(rows)[:10][::-1]
        names = [f"{row['subsystem']}, {str(row['variable']).replace('_', ' ')}: {row['bin']}" for row in shown]
        right.barh(range(len(shown)), [100 * row["share"] for row in shown], color=BLUE, height=0.6)
        right.set_yticks(range(len(shown)), names, fontsize=6.5)
        dress(right, "")
        right.set_xlabel("Share of the excess error (%)", color=INK, fontsize=8.5)

    return draw((9.6, 3.8), "where", paint)


def _map(figure: Any, axis: Any, velocity: Array, arm: Array, force: Array) -> None:
    dress(axis, "Arm angle (deg)")
    axis.set_xlabel("Speed of the sliders (mm/s)", color=INK, fontsize=8.5)
    if len(velocity) < FEWEST or np.ptp(arm) == 0.0:
        axis.text(0.5, 0.5, "the arm hardly slides in these tests", ha="center", transform=axis.transAxes, fontsize=8)
        return
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


def draw_horizon(curves: Sequence[HorizonCurve]) -> str:
    """Return the error of the arm (deg) and its floor against the time since a restart (ms)."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        for number, one in enumerate(curves):
            colour = COLOURS[number % len(COLOURS)]
            axis.plot(one.time * 1e3, np.degrees(one.rms), color=colour, linewidth=1.4, label=one.name)
            if one.floor is not None:
                label = f"{one.name}, floor"
                floor = np.degrees(one.floor)
                axis.plot(one.time * 1e3, floor, color=colour, linewidth=1.0, linestyle=(0, (4, 2.5)), label=label)
        dress(axis, "Error of the arm (deg, rms)")
        axis.set_xlabel("Time since the restart from measured states (ms)", color=INK, fontsize=8.5)
        axis.legend(fontsize=8, frameon=False)

    return draw((7.4, 3.4), "horizon", paint)


def draw_errors(rows: Sequence[tuple[str, float]]) -> str:
    """Return bars of named errors over the repetition scatter, with the floor as a line at 1."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        shown = list(rows)[::-1]
        colours = [GREEN if index == 0 else RED for index in range(len(shown))]
        axis.barh(range(len(shown)), [value for _, value in shown], color=colours, height=0.55)
        axis.set_yticks(range(len(shown)), [name for name, _ in shown], fontsize=8)
        axis.axvline(1.0, color=INK, linewidth=1.0, linestyle=(0, (4, 2.5)))
        dress(axis, "")
        axis.set_xlabel("Error on tests not used for the fit, over the floor", color=INK, fontsize=8.5)

    return draw((7.4, 0.9 + 0.5 * len(rows)), "errors", paint)


def dress(axis: Any, label: str) -> None:
    """Give an axis the look of all pictures."""
    axis.set_ylabel(label, color=INK, fontsize=8.5)
    axis.grid(True, axis="y", color=GRID, linewidth=0.5)
    axis.set_axisbelow(True)
    axis.tick_params(colors=INK, labelsize=8)
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)
