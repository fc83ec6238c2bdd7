"""The picture of a profile of the likelihood: how much worse the tests are explained as one parameter is held elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, INK
from hjcamp.report.pictures.drawing import draw, dress

# Of the largest value over the smallest: more than that is drawn over its logarithm.
WIDE = 30.0


def draw_profile(label: str, values: NDArray[np.float64], rise: NDArray[np.float64], value: float, limit: float) -> str:
    """Return the SVG of ``rise`` (k,) over ``values`` (k,) with the limit of the 95 % interval and the fitted ``value``."""
    top = 2.2 * limit

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        shown = np.minimum(np.where(np.isfinite(rise), rise, 10.0 * top), 10.0 * top)
        axis.plot(values, shown, color=BLUE, marker="o", markersize=3.0, linewidth=1.4)
        axis.axhline(limit, color=INK, linewidth=1.0, linestyle=(0, (4, 2.5)))
        axis.plot([value], [0.0], color=INK, marker="|", markersize=9.0)
        axis.set_ylim(-0.04 * top, top)
        near = values[shown <= top]
        if near.min() > 0.0 and near.max() > WIDE * near.min():
            axis.set_xscale("log")
        elif len(near) > 1 and near.min() < near.max():
            over = 0.25 * float(np.ptp(near))
            axis.set_xlim(
                max(float(near.min()) - over, float(values.min())), min(float(near.max()) + over, float(values.max()))
            )
        dress(axis, "2 log-likelihood ratio")
        axis.set_xlabel(label, color=INK, fontsize=8.5)

    return draw((3.6, 2.4), "profile", paint)
