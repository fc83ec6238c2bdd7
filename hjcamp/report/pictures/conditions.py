"""One picture per condition: its signals over time in panels, with the spread of the repetitions."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.report.runs.spread import Condition, panels_known

# Colours of Okabe and Ito, told apart by colour-blind readers; the page puts its own shades in their place.
INK = "#1b1f24"
GRID = "#d0d4d9"
BLUE = "#0072b2"
RED = "#d55e00"
GREEN = "#009e73"
PURPLE, ORANGE, TEAL = "#cc79a7", "#e69f00", "#56b4e9"
COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, TEAL)
#: Of models, in their order on a page: those of the explorer (explorer.js).
MODELS = (RED, BLUE, GREEN, PURPLE, ORANGE, TEAL)
PAPER = "#fffffe"  # white that nothing else is: the page puts its own in its place
WIDTH, HEIGHT = 7.4, 6.6
LEFT, RIGHT, TOP, BOTTOM, GAP = 0.1, 0.98, 0.965, 0.065, 0.045

# In labels, it stands for what the readings are: measured or simulated.
OBSERVED = "{observed}"


class Curve(NamedTuple):
    """One signal in a panel."""

    signal: str
    label: str
    colour: str
    dashed: bool = False


class Panel(NamedTuple):
    """One panel: its quantity with unit, and the curves that may be in it."""

    title: str
    curves: tuple[Curve, ...]
    share: float = 1.0


def panels_by_unit(signals: Sequence[str]) -> list[Panel]:
    """Return one panel for each unit of the signals of another plant, the curves in their order."""
    units: dict[str, list[str]] = {}
    for name in signals:
        units.setdefault(unit_of_field(name, "a figure").shown, []).append(name)
    panels = []
    for unit, names in units.items():
        curves = [
            Curve(
                name,
                name.rpartition("_")[0].replace("_", " "),
                INK if name.startswith("reference_") else COLOURS[k % len(COLOURS)],
                name.startswith("reference_"),
            )
            for k, name in enumerate(names)
        ]
        title = names[0].rpartition("_")[0].replace("_", " ") if len(names) == 1 else "signals"
        panels.append(Panel(f"{title} ({unit})", tuple(curves)))
    return panels


# Every text, line and ground that matplotlib draws by itself has one of our colours, so that the page can take them over.
SETTINGS: dict[str, Any] = {
    "svg.fonttype": "none", "font.size": 9.0, "path.simplify_threshold": 0.2,
    "figure.facecolor": PAPER, "axes.facecolor": PAPER, "savefig.facecolor": PAPER, "axes.edgecolor": INK,
    "axes.labelcolor": INK, "axes.titlecolor": INK, "text.color": INK, "xtick.color": INK, "ytick.color": INK,
    "legend.labelcolor": INK, "legend.facecolor": PAPER, "patch.edgecolor": INK, "grid.color": GRID,
}  # fmt: skip


@contextmanager
def own_settings(settings: Mapping[str, Any] = SETTINGS) -> Iterator[None]:
    """Draw by ``settings`` over matplotlib's own defaults, whatever a matplotlibrc of the user or a notebook asks for."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(settings)  # type: ignore[arg-type]
        yield


def draw_condition(condition: Condition) -> str:
    """Return the picture of one condition as SVG text: lines as `Condition.lines` says, range of the repetitions as a band."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    with own_settings(SETTINGS | {"svg.hashsalt": condition.name}):
        figure = _frame(tuple(condition.signals), condition.banded, condition.observed)
        figure.show(condition)
        buffer = io.StringIO()
        canvas = FigureCanvasSVG(figure.figure)
        canvas.print_svg(buffer, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return tidy(buffer.getvalue())


class Frame:
    """The figure of conditions with the same signals: panels, axes and legends are made once, and filled for each."""

    def __init__(self, signals: Sequence[str], banded: bool, observed: str) -> None:
        from matplotlib.figure import Figure

        self._observed = observed
        self.figure = Figure(figsize=(WIDTH, HEIGHT))
        self.figure.patch.set_visible(False)
        self._lines: dict[str, Any] = {}
        self._bands: dict[str, Any] = {}
        self._others: dict[str, list[Any]] = {}
        known = panels_known()
        panels = [panel for panel in known.PANELS if any(curve.signal in signals for curve in panel.curves)]
        panels += panels_by_unit([name for name in signals if name not in known.SIGNALS])
        shares = sum(panel.share for panel in panels)
        usable = TOP - BOTTOM - GAP * (len(panels) - 1)
        bottom = TOP + GAP
        for panel in panels:
            height = usable * panel.share / shares
            bottom -= height + GAP
            axes = self.figure.add_axes((LEFT, bottom, RIGHT - LEFT, height))
            curves = [curve for curve in panel.curves if curve.signal in signals]
            self._add_curves(axes, curves, banded)
            _dress(axes, panel.title, legend=len(curves) > 1, last=panel is panels[-1])

    def _add_curves(self, axes: Any, curves: Sequence[Curve], banded: bool) -> None:
        from matplotlib.collections import PolyCollection

        for curve in curves:
            if banded and not curve.dashed:
                band = PolyCollection([], color=curve.colour, alpha=0.22, linewidth=0.0)
                self._bands[curve.signal] = axes.add_collection(band, autolim=False)
            style = (0, (4, 2.5)) if curve.dashed else "-"
            (line,) = axes.plot(
                [], [], color=curve.colour, linewidth=1.2, linestyle=style, label=curve.label.format(observed=self._observed)
            )
            self._lines[curve.signal] = line
            self._others[curve.signal] = []

    def show(self, condition: Condition) -> None:
        """Fill the panels with one condition."""
        from matplotlib.transforms import Bbox

        time = condition.time
        for axes in self.figure.axes:
            axes.dataLim.set(Bbox.null())
        for name, line in self._lines.items():
            spread = condition.signals[name]
            bold, others = condition.lines(name)
            line.set_data(time, bold)
            for one in self._others[name]:
                one.remove()
            self._others[name] = [
                line.axes.plot(time, one, color=line.get_color(), linewidth=0.4, alpha=0.6, zorder=1.5)[0] for one in others
            ]
            line.axes.update_datalim(line.get_xydata())
            if name in self._bands:
                # As fill_between makes it: along the lower edge, back along the upper one.
                low, high = np.column_stack([time, spread.lowest]), np.column_stack([time, spread.highest])
                outline = np.vstack([high[:1], low, high[-1:], high[::-1]])
                self._bands[name].set_verts([outline])
                line.axes.update_datalim(outline)
        for axes in self.figure.axes:
            if len(time):
                axes.set_xlim(0.0, float(np.ceil((time[-1] + time[0]) * 100.0) / 100.0))
            axes.autoscale_view(scalex=not len(time))


@lru_cache(maxsize=4)
def _frame(signals: tuple[str, ...], banded: bool, observed: str) -> Frame:
    return Frame(signals, banded, observed)


def _dress(axes: Any, title: str, legend: bool, last: bool) -> None:
    axes.margins(y=0.08)
    axes.set_ylabel(title, color=INK, fontsize=8.5)
    axes.yaxis.set_label_coords(-0.08, 0.5)
    axes.locator_params(axis="y", nbins=5)
    axes.grid(True, axis="y", color=GRID, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.patch.set_visible(False)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(INK)
        spine.set_linewidth(0.7)
    axes.tick_params(colors=INK, labelsize=8, width=0.7, length=3)
    if legend:
        axes.legend(
            loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=3, fontsize=8, frameon=False, labelcolor=INK,
            borderaxespad=0.0, borderpad=0.0, handlelength=1.8, columnspacing=1.4,
        )  # fmt: skip
    # An axis without labels costs as much to draw as one with them: only the last panel has one.
    axes.xaxis.set_visible(last)
    if last:
        axes.set_xlabel("Time (s)", color=INK, fontsize=8.5)


def tidy(svg: str) -> str:
    """Return the drawing without prologue, comments and the group names that several pictures of a page would share."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r' id="[\w.]+_\d+"', "", svg)
    # coordinates alone: a number between tags is read by people
    svg = re.sub(r"<[^>]*>", lambda tag: re.sub(r"(?<=\d\.\d\d)\d+", "", tag[0]), svg)
    return re.sub(r"\n\s+", "\n", svg)
