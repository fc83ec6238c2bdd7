"""Picture of what the best model leaves: force or flow over its driver, with the even and the odd part."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, GREEN, INK, RED
from hjcamp.report.pictures.drawing import draw, dress

Array = NDArray[np.float64]


def draw_unexplained(horizontal: str, vertical: str, centres: Array, forward: Array, backward: Array) -> str:
    """Return means (bins,) over a driver, moving forwards and backwards, next to their even and odd part; NaN is left out."""

    def paint(figure: Any) -> None:
        left, right = figure.subplots(1, 2, sharey=True)
        parts = {
            left: ((forward, BLUE, "moving in the positive direction"), (backward, RED, "in the negative direction")),
            right: (
                (0.5 * (forward + backward), GREEN, "even: the same both ways, as a spring"),
                (0.5 * (forward - backward), INK, "odd: turns with the motion, as friction"),
            ),
        }
        for axis, curves in parts.items():
            for values, colour, name in curves:
                seen = np.isfinite(values)
                axis.plot(centres[seen], values[seen], color=colour, linewidth=1.3, marker="o", markersize=3, label=name)
            axis.axhline(0.0, color=INK, linewidth=0.6)
            axis.margins(y=0.2)
            dress(axis, vertical if axis is left else "")
            axis.set_xlabel(horizontal, color=INK, fontsize=8.5)
            axis.legend(fontsize=8, frameon=False)

    return draw((9.6, 3.6), "unexplained", paint)
