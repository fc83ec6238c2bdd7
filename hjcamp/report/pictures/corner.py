"""The corner plot of fitted parameters: how well each is known, and which two the tests hardly tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, INK
from hjcamp.report.pictures.drawing import draw, dress

Array = NDArray[np.float64]
#: More parameters than these make panels that nobody reads.
MOST = 7
REACH = 3.0
#: Radii of the ellipses that hold 68 and 95 % of a normal pair: sqrt(-2 ln(1 - share)).
RADII = tuple(float(np.sqrt(-2.0 * np.log(1.0 - share))) for share in (0.68, 0.95))


#: Of two parameters that are more alike a test says hardly more than of their sum or ratio.
ALIKE = 0.95


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


def draw_corner(names: Sequence[str], values: Sequence[str], correlation: Array) -> str:
    """Return the SVG of two and more parameters: their names, values in words, correlations (k, k); the first ``MOST`` of them.

    All axes count standard errors from the value that was fitted, so that scales of any size can be read.
    """
    names = [name.replace(" ", "\n") for name in names[:MOST]]
    count = len(names)

    def paint(figure: Any) -> None:
        axes = figure.subplots(count, count, squeeze=False, sharex=True)
        for (row, column), axis in np.ndenumerate(axes):
            if column > row:
                axis.set_axis_off()
                axis.text(0.0, 0.5, told_correlation(float(correlation[row, column])).replace("-", "−"), ha="center",
                          va="center", fontsize=8, color=INK, transform=axis.get_xaxis_transform())  # fmt: skip
                continue
            dress(axis, "")
            axis.set_xlim(-REACH, REACH)
            axis.set_xticks([-2, 0, 2])
            axis.tick_params(labelsize=7)
            if row == column:
                away = np.linspace(-REACH, REACH, 61)
                axis.plot(away, np.exp(-0.5 * away**2), color=BLUE, linewidth=1.2)
                axis.set_ylim(0.0, 1.15)
                axis.set_yticks([])
                axis.set_title(values[row], fontsize=7, color=INK)
            else:
                for radius, width in zip(RADII, (1.4, 0.8), strict=True):
                    axis.plot(*ellipse(float(correlation[row, column]), radius), color=BLUE, linewidth=width)
                axis.plot(0.0, 0.0, "+", color=INK, markersize=4)
                axis.set_ylim(-REACH, REACH)
                axis.set_yticks([-2, 0, 2], ["−2", "0", "2"] if not column else [])
            if row == count - 1:
                axis.set_xlabel(names[column], fontsize=7.5, color=INK)
            if not column:
                axis.set_ylabel(names[row], fontsize=7.5, color=INK)

    side = max(1.2 * count, 3.0)
    return draw((min(side + 1.2, 9.6), side), "corner", paint)
