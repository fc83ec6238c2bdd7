"""The corner plot of fitted parameters: how well each is known, and which two the tests hardly distinguish."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hjcamp.report.pictures.conditions import BLUE, INK
from hjcamp.report.pictures.drawing import draw

Array = NDArray[np.float64]
#: More parameters than these make panels that nobody reads.
MOST = 7
REACH = 3.0
#: Radii of the ellipses that hold 68 and 95 % of a normal pair: sqrt(-2 ln(1 - share)).
RADII = tuple(float(np.sqrt(-2.0 * np.log(1.0 - share))) for share in (0.68, 0.95))


#: Of two parameters that are more alike a test says hardly more than of their sum or ratio.
SIMILAR = 0.95
#: Margins of a panel: left, right and below; above, where the value stands.
SIDE, TOP = 0.06, 0.16


def correlation_of(covariance: Array) -> Array:
    """Return the correlations (k, k) of a covariance (k, k); those of a parameter without spread are zero."""
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    size = np.outer(spread, spread)
    found = np.divide(covariance, size, out=np.zeros_like(covariance), where=size > 0.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(np.clip(found, -1.0, 1.0))


def told_correlation(value: float) -> str:
    """Return a correlation with sign and two decimals; one that rounds to nothing is 0."""
    return "0" if abs(value) < 0.005 else f"{value:+.2f}"


def ellipse(correlation: float, radius: float) -> Array:
    r"""Return points (2, 73) of the contour :math:`z^T R^{-1} z = r^2` of two standardized normal values."""
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    other = correlation * np.cos(angle) + np.sqrt(1.0 - correlation**2) * np.sin(angle)
    return np.asarray(radius * np.stack([np.cos(angle), other]))


def _in_panel(row: int, column: int, x: ArrayLike, y: ArrayLike) -> Array:
    """Return the points (n, 2) of standardized values x and y (n,) in a panel, a unit square without its margins."""
    shares = [np.atleast_1d(np.asarray(one, dtype=float)) / (2.0 * REACH) for one in (x, y)]
    across = column + 0.5 + (1.0 - 2.0 * SIDE) * shares[0]
    down = row + 0.5 * (TOP + 1.0 - SIDE) - (1.0 - SIDE - TOP) * shares[1]
    return np.column_stack(np.broadcast_arrays(across, down))


def draw_corner(names: Sequence[str], values: Sequence[str], correlation: Array) -> str:
    """Return the SVG of two and more parameters: their names, values in words, correlations (k, k); the first ``MOST`` of them.

    All axes count standard errors from the value that was fitted, so that scales of any size can be read.
    """
    names = [name.replace(" ", "\n") for name in names[:MOST]]
    count = len(names)

    def paint(figure: Any) -> None:
        from matplotlib.collections import LineCollection

        # one axes for all panels: laying out count x count of them takes longer than the rest of the page
        axis = figure.subplots()
        thick: list[Array] = []
        thin: list[Array] = []
        frames: list[Array] = []
        for column, row in itertools.combinations_with_replacement(range(count), 2):
            frames.append(_in_panel(row, column, [-REACH, -REACH, REACH], [REACH, -REACH, -REACH]))
            if row == column:
                away = np.linspace(-REACH, REACH, 61)
                thick.append(_in_panel(row, column, away, REACH * (1.7 * np.exp(-0.5 * away**2) - 1.0)))
                axis.text(column + 0.5, row + TOP, values[row], fontsize=7, color=INK, ha="center", va="bottom")
                continue
            for radius, lines in zip(RADII, (thick, thin), strict=True):
                lines.append(_in_panel(row, column, *ellipse(float(correlation[row, column]), radius)))
            axis.plot(*_in_panel(row, column, [0.0], [0.0]).T, "+", color=INK, markersize=4)
            told = told_correlation(float(correlation[column, row])).replace("-", "−")
            axis.text(row + 0.5, column + 0.5, told, ha="center", va="center", fontsize=8, color=INK)
        for lines, colour, width in ((frames, INK, 0.6), (thick, BLUE, 1.3), (thin, BLUE, 0.8)):
            axis.add_collection(LineCollection(lines, colors=colour, linewidths=width))
        ticks = {tick: f"{tick}".replace("-", "−") for tick in (-2, 0, 2)}
        places = [(each, tick) for each in range(count) for tick in ticks]
        axis.set_xticks([_in_panel(0, each, tick, 0.0)[0, 0] for each, tick in places], [*ticks.values()] * count, fontsize=7)
        upright = [_in_panel(each, 0, 0.0, tick)[0, 1] for each, tick in places if each]
        axis.set_yticks(upright, [*ticks.values()] * (count - 1), fontsize=7)
        for each, name in enumerate(names):
            axis.text(each + 0.5, count + 0.22, name, fontsize=7.5, color=INK, ha="center", va="top")
            axis.text(-0.2 - 0.02 * count, each + 0.5, name, fontsize=7.5, color=INK, ha="center", va="center", rotation=90)
        axis.set(xlim=(0.0, count), ylim=(count, 0.0))
        axis.tick_params(length=2, color=INK, labelcolor=INK)
        axis.spines[:].set_visible(False)

    side = max(1.2 * count, 3.0)
    return draw((min(side + 1.2, 9.6), side), "corner", paint)
