"""The picture of one effect for the catalogue: what it changes, over time and over what it reads."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, INK
from hjcamp.report.pictures.drawing import draw, dress
from hjcamp.report.pictures.prediction import readable


def draw_change(
    time: NDArray[Any],
    changed: tuple[str, str],
    without: NDArray[Any],
    with_: NDArray[Any],
    driver: tuple[str, str],
    values: NDArray[Any],
) -> str:
    """Return a quantity (n,) without and with an effect over time (s), and their difference over a driver (n,).

    ``changed`` and ``driver`` are name and SI unit.
    """
    up, [plain, full] = readable(changed[0].replace("_", " "), changed[1], without, with_)
    change, [difference] = readable("change", changed[1], with_ - without)
    across, [over] = readable(driver[0].replace("_", " "), driver[1], values)

    def paint(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.3, 1.0])
        left.plot(time, plain, color=INK, linewidth=1.1, linestyle="--", label="without")
        left.plot(time, full, color=BLUE, linewidth=1.3, label="with")
        left.legend(fontsize=8, frameon=False)
        left.margins(y=0.2)
        right.plot(over, difference, ".", color=BLUE, markersize=4)
        dress(left, up)
        dress(right, change)
        left.set_xlabel("time (s)", color=INK, fontsize=8.5)
        right.set_xlabel(across, color=INK, fontsize=8.5)

    return draw((7.4, 2.8), f"{changed[0]} over {driver[0]}", paint)
