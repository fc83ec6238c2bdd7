"""How every picture is drawn: as SVG text or as a figure for a notebook, with one look; and bars of errors."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from typing import Any

from hjcamp.report.pictures.conditions import GRID, INK, MODELS, PURPLE, SETTINGS, own_settings

# Who wants figures instead of their SVG: the class of the figure, and where it goes.
_ASKED: ContextVar[tuple[type[Any], list[Any]] | None] = ContextVar("asked", default=None)


def kept_figure(function: Callable[..., str], *given: Any, kind: type[Any]) -> Any:
    """Return the figure, of class ``kind``, that ``function`` gives to `draw`."""
    found: list[Any] = []
    token = _ASKED.set((kind, found))
    try:
        function(*given)
    finally:
        _ASKED.reset(token)
    return found[-1]


def draw(size: tuple[float, float], name: str, paint: Callable[[Any], None]) -> str:
    """Return the SVG text of a figure that ``paint`` fills; equal content gives equal text."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with own_settings(SETTINGS | {"svg.hashsalt": name}):
        asked = _ASKED.get()
        figure = (asked[0] if asked else Figure)(figsize=size, layout="constrained")
        paint(figure)
        if asked:
            asked[1].append(figure)
            return ""
        buffer = io.StringIO()
        nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
        FigureCanvasSVG(figure).print_svg(buffer, metadata=nothing)
    return buffer.getvalue()


def draw_errors(rows: Sequence[tuple[str, float]], over: str, noise_floor: bool = True, before: int = 0) -> str:
    """Return bars of named errors, ``over`` what; with a ``noise_floor`` the last of them is that, with a line at 1.

    The colours are those of models on a page, from the first one behind so many that stand ``before`` these and have one of their own.
    """

    def paint(figure: Any) -> None:
        axis = figure.subplots()
        shown = list(rows)[::-1]
        models = (
            [PURPLE] * before
            + [MODELS[k % len(MODELS)] for k in range(len(shown) - before - noise_floor)]
            + [INK] * noise_floor
        )
        colours = models[::-1]
        bars = axis.barh(range(len(shown)), [value for _, value in shown], color=colours, height=0.55)
        axis.bar_label(bars, [f"{value:.2f}" for _, value in shown], padding=3, fontsize=8, color=INK)
        axis.set_yticks(range(len(shown)), [name for name, _ in shown], fontsize=8)
        if noise_floor:
            axis.axvline(1.0, color=INK, linewidth=1.0, linestyle=(0, (4, 2.5)))
        axis.margins(x=0.1)
        dress(axis, "")
        axis.set_xlabel(over.capitalize(), color=INK, fontsize=8.5)

    return draw((7.4, 0.9 + 0.45 * len(rows)), "errors", paint)


def dress(axis: Any, label: str) -> None:
    """Give an axis the look of all pictures."""
    axis.set_ylabel(label, color=INK, fontsize=8.5)
    axis.grid(True, axis="y", color=GRID, linewidth=0.5)
    axis.set_axisbelow(True)
    axis.tick_params(colors=INK, labelsize=8)
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)
