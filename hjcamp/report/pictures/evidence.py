"""The evidence picture of a diagnosis: what is missing over its driver, the named law through it, the same after, and chance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, GREEN, GRID, INK, MODELS, PURPLE, RED
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.pictures.prediction import readable
from hjcamp.report.tables.correlations import Correlation

Array = NDArray[np.float64]
SIZE = (4.8, 3.3)
STRIP = (4.8, 1.9)
BOTH, FORWARD, BACKWARD = "both ways", "forwards", "backwards"
COLOURS = {BOTH: GREEN, FORWARD: BLUE, BACKWARD: RED}
# Of curves that are no ways of moving, such as those of conditions, in order.
OTHERS = (BLUE, RED, GREEN, INK, PURPLE)
LINES = {BOTH: "-", FORWARD: "--", BACKWARD: ":"}
# So few values are bins, and get a dot each.
FEW = 24
LONGEST_NAME = 32


@dataclass(frozen=True)
class Branch:
    """A curve for one way of moving or one condition: values ``y`` with 95 % band over ``x``, each (n,), SI; NaN where not seen."""

    way: str
    x: Array
    y: Array
    low: Array | None = None
    high: Array | None = None


@dataclass(frozen=True)
class Missing:
    """What a calibrated model misses over one driver, what the named effect says there, and what is missing after it.

    Names as people read them, SI units; ``law`` and ``after`` are empty where nothing was named. ``forms`` are formulas of what is
    missing, each called by its ``way``.
    """

    driver: str
    driver_unit: str
    quantity: str
    unit: str
    before: tuple[Branch, ...]
    law: tuple[Branch, ...] = ()
    after: tuple[Branch, ...] = ()
    name: str = ""
    forms: tuple[Branch, ...] = ()


def draw_missing(missing: Missing) -> dict[str, str]:
    """Return pictures by name: ``before`` with the law through it, and ``after`` on the same scale where there is one."""
    across, up, (before, law, after, forms) = _scaled(missing)
    limits = _limits([one.y for one in (*before, *law, *after)])
    labels = across, up, limits
    found = {"before": _panel(before, law, missing.name, "missing: calibrated model", labels, () if after or law else forms)}
    if after:
        found["after"] = _panel(after, (), missing.name, f"missing: {_shortly(missing.name)}", labels)
    return found


def _shortly(name: str) -> str:
    """Return what was added, in words that fit above a panel."""
    return f"with {name}" if len(name) <= LONGEST_NAME else "with what was found"


def _scaled(missing: Missing) -> tuple[str, str, list[list[Branch]]]:
    """Return the labels of both axes, and the groups of branches in the units of these labels."""
    groups = (missing.before, missing.law, missing.after, missing.forms)
    flat = [one for group in groups for one in group]
    across, xs = readable(missing.driver, missing.driver_unit, *(one.x for one in flat))
    columns = [column for one in flat for column in (one.y, one.low, one.high) if column is not None]
    up, ys = readable(missing.quantity, missing.unit, *columns)
    values, places = iter(ys), iter(xs)
    return across, up, [
        [
            Branch(
                one.way, next(places), next(values), next(values) if one.low is not None else None,
                next(values) if one.high is not None else None,
            )
            for one in group
        ]
        for group in groups
    ]  # fmt: skip


def _panel(
    branches: Sequence[Branch],
    law: Sequence[Branch],
    name: str,
    title: str,
    labels: tuple[str, str, tuple[float, float]],
    forms: Sequence[Branch] = (),
) -> str:
    across, up, limits = labels

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        for one, other in zip(branches, cycle(OTHERS), strict=False):
            marker = "o" if len(one.x) <= FEW else ""
            _branch(axis, one, COLOURS.get(one.way, other), f"missing, {one.way}", marker=marker, markersize=3)
        for one in law:
            _branch(axis, one, INK, f"{name}, {one.way}", linestyle=LINES[one.way])
        for one, line in zip(forms, LINES.values(), strict=False):
            _branch(axis, one, INK, one.way, linestyle=line)
        axis.axhline(0.0, color=INK, linewidth=0.6)
        axis.set_ylim(*limits)
        dress(axis, up)
        axis.set_xlabel(across, color=INK, fontsize=8.5)
        axis.set_title(title, color=INK, fontsize=9, loc="left")
        axis.legend(fontsize=7.5, frameon=False)

    return draw(SIZE, title, paint)


def _branch(axis: Any, one: Branch, colour: str, label: str, **style: Any) -> None:
    seen = np.isfinite(one.y)
    if one.low is not None and one.high is not None:
        axis.fill_between(one.x[seen], one.low[seen], one.high[seen], color=colour, alpha=0.2, linewidth=0)
    axis.plot(one.x[seen], one.y[seen], color=colour, linewidth=1.4, label=label, **style)


def _limits(values: Sequence[Array]) -> tuple[float, float]:
    seen = np.concatenate([one[np.isfinite(one)] for one in values] or [np.zeros(1)])
    low, high = (min(float(seen.min()), 0.0), max(float(seen.max()), 0.0)) if len(seen) else (-1.0, 1.0)
    room = 0.25 * (high - low) or 1.0
    return low - room, high + room


def draw_worst_test(
    title: str,
    quantity: str,
    unit: str,
    time: Array,
    measured: Array,
    models: Sequence[tuple[str, Array]],
    *,
    observed: str = "measured",
) -> str:
    """Return the worst test: measured (n,) and each model's prediction above, their residuals below; SI or field units."""
    label, scaled = readable(quantity, unit, measured, *(values for _, values in models))
    residual, [_, *left] = readable("residual", unit, measured, *(values - measured for _, values in models))

    def paint(figure: Any) -> None:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, 1))
        above.plot(time, scaled[0], color=INK, linewidth=1.6, alpha=0.5, label=observed)
        for (name, _), values, error, colour in zip(models, scaled[1:], left, MODELS, strict=False):
            above.plot(time, values, color=colour, linewidth=0.9, label=name)
            below.plot(time, error, color=colour, linewidth=0.9)
        below.axhline(0.0, color=INK, linewidth=0.6)
        above.set_title(title, color=INK, fontsize=9, loc="left")
        above.legend(fontsize=7.5, frameon=False, ncols=3)
        above.margins(y=0.2)
        below.set_title(f"residual: model - {observed}", color=INK, fontsize=7.5, loc="left")
        dress(above, label)
        dress(below, residual)
        below.set_title(f"residual: model - {observed}", color=INK, fontsize=8, loc="left")
        below.set_xlabel("time (s)", color=INK, fontsize=8.5)

    return draw(SIZE, title, paint)


def draw_gains(chance: Array, gain: float | None, what: str, unit: str = "log-likelihood") -> str:
    """Return the gains (draws,) on surrogate data as a strip, and the real one marked."""

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        spread = np.random.default_rng(1).uniform(-0.3, 0.3, len(chance))
        axis.plot(chance, spread, ".", color=INK, markersize=4, alpha=0.5, label=f"chance: {what}")
        if gain is not None:
            axis.axvline(gain, color=RED, linewidth=0.9)
            axis.plot([gain], [0.0], "D", color=RED, markersize=7, label="these tests")
        axis.set_yticks([])
        axis.set_ylim(-1.0, 1.6)
        dress(axis, "")
        axis.set_title("the best gain and chance", color=INK, fontsize=9, loc="left")
        axis.set_xlabel(f"largest gain of the library ({unit})", color=INK, fontsize=8.5)
        axis.legend(fontsize=7.5, frameon=False, loc="upper center", ncols=2)

    return draw(STRIP, "gains", paint)


def draw_explained(names: Sequence[str], shares: Sequence[float], kept: Sequence[bool], delta: float) -> str:
    """Return the share of the error above repeatability that each model explains as bars, those that are not ruled out filled.

    ``delta`` is the smallest share that matters.
    """

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        places = np.arange(len(names))[::-1]
        for place, share, stays in zip(places, shares, kept, strict=True):
            fill, edge = (RED, RED) if stays else ("none", INK)
            axis.barh(place, max(share, 0.0), height=0.6, color=fill, edgecolor=edge, linewidth=0.8)
        axis.axvline(
            delta, color=INK, linewidth=0.9, linestyle="--", label=f"smallest share that matters ({100.0 * delta:.0f} %)"
        )
        axis.set_yticks(places, list(names), fontsize=7.5)
        axis.set_xlim(0.0, max(1.0, *shares))
        dress(axis, "")
        axis.set_title("what each model explains; filled: not ruled out", color=INK, fontsize=9, loc="left")
        axis.set_xlabel("share of the error above repeatability, blocks left out", color=INK, fontsize=8.5)
        axis.legend(fontsize=7.5, frameon=False, loc="lower right")

    return draw((SIZE[0], 0.9 + 0.24 * max(len(names), 3)), "explained", paint)


def draw_correlations(
    models: Sequence[tuple[str, Sequence[Correlation]]], repetitions: Sequence[Correlation] = ()
) -> dict[str, str]:
    """Return pictures by name: the residual's autocorrelation, and its correlation with an input, where chance stays (95 %).

    ``repetitions`` are the correlations of what repetitions do not share: drawn dashed, as what no model can take.
    """
    return {
        f"correlation_{place + 1}": _correlation(
            [(name, found[place]) for name, found in models], repetitions[place] if place < len(repetitions) else None
        )
        for place in range(len(models[0][1]))
    }


def _correlation(models: Sequence[tuple[str, Correlation]], repetitions: Correlation | None) -> str:
    first = models[0][1]

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        axis.fill_between(first.lags, -first.band, first.band, color=GRID, alpha=0.8, linewidth=0, label="chance")
        for (name, one), colour in zip(models, MODELS, strict=False):
            axis.plot(one.lags, one.values, color=colour, linewidth=1.1, label=name)
        if repetitions is not None:
            axis.plot(repetitions.lags, repetitions.values, "--", color=INK, linewidth=1.0, label="between repetitions")
        axis.axhline(0.0, color=INK, linewidth=0.6)
        dress(axis, "correlation")
        axis.set_title(first.name, color=INK, fontsize=9, loc="left")
        axis.set_xlabel("lag (s)", color=INK, fontsize=8.5)
        axis.legend(fontsize=7.5, frameon=False)

    return draw((SIZE[0], 2.5), first.name, paint)
