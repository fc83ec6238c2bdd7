"""A map: one indicator over two parameters that were varied, with the number in each cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import INK, tidy
from hjcamp.report.pictures.drawing import draw

Array = NDArray[np.float64]


def draw_map(title: str, x: tuple[str, Sequence[float]], y: tuple[str, Sequence[float]], values: Array) -> str:
    """Return the SVG of a map: ``values`` (len(y), len(x)), nan where there is no test; cells are not to scale."""

    def paint(figure: Any) -> None:
        axes = figure.subplots()
        image = axes.imshow(values, origin="lower", aspect="auto", cmap="Blues")
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        for (row, column), value in np.ndenumerate(values):
            dark = high > low and (value - low) / (high - low) > 0.6
            text = f"{value:.3g}" if np.isfinite(value) else "–"
            axes.text(column, row, text, ha="center", va="center", fontsize=8, color="white" if dark else INK)
        for axis, (name, given) in ((axes.xaxis, x), (axes.yaxis, y)):
            axis.set_ticks(range(len(given)), [f"{one:g}" for one in given])
            axis.set_label_text(name, fontsize=8.5)
        axes.tick_params(labelsize=8)
        axes.set_title(title, fontsize=9, loc="left")
        figure.colorbar(image, ax=axes).ax.tick_params(labelsize=8)

    return tidy(draw((6.6, 4.0), title, paint))
