"""The block diagram of a plant: its places, and which of them each one depends on, directly or through a state."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hjcamp.model.plant import Plant
from hjcamp.model.port import Port
from hjcamp.model.vocabulary import Vocabulary, read_vocabulary

INK = "#1b1f24"
COLOURS = {
    "actuator": "#0072b2", "path": "#56b4e9", "store": "#009e73", "contact": "#d55e00", "body": "#cc79a7",
    "transmission": "#e69f00", "sensor": "#555b63",
}  # fmt: skip
BOX = (1.7, 0.62)
STEP = (2.5, 1.15)
WORD = re.compile(r"\b[A-Za-z_]\w*")


def links(vocabulary: Vocabulary) -> tuple[set[tuple[str, str]], set[tuple[str, str]]]:
    """Return pairs (from, to) of places: what one computes from another's lines, and from a state that another drives."""
    owner = {
        line: port.name
        for port in vocabulary.ports.values()
        for line in vocabulary.signals
        if line == port.name or line.startswith(f"{port.name}_")
    }
    behind: dict[str, set[str]] = {}
    for one in vocabulary.statements:
        behind[f"s_{one.target}" if one.mark == "rate" else one.target] = set(WORD.findall(one.expression))
    direct: set[tuple[str, str]] = set()
    through: set[tuple[str, str]] = set()
    for line, target in owner.items():
        lines = {word for word in behind[line] if not word.startswith("s_")}
        direct |= {(source, target) for source in _sources(lines, behind, owner) if source != target}
        through |= {(source, target) for source in _sources(behind[line] - lines, behind, owner) if source != target}
    return direct, through - direct


def _sources(words: set[str], behind: dict[str, set[str]], owner: dict[str, str]) -> set[str]:
    """Return the places that these words come from, through lines and states that belong to none."""
    found: set[str] = set()
    seen: set[str] = set()
    left = sorted(words)
    while left:
        word = left.pop()
        if word in owner:
            found.add(owner[word])
        elif word not in seen:
            left += sorted(behind.get(word, ()))
        seen.add(word)
    return found


def columns(ports: dict[str, Port], direct: set[tuple[str, str]]) -> list[list[str]]:
    """Return the places in columns: each stands to the right of all that it is computed from."""
    depth = dict.fromkeys(ports, 0)
    for _ in ports:
        for source, target in direct:
            depth[target] = max(depth[target], min(depth[source] + 1, len(ports)))
    last = max(depth.values(), default=0) + 1
    depth |= {name: last for name, port in ports.items() if port.kind == "sensor"}
    return [[name for name in ports if depth[name] == level] for level in sorted(set(depth.values()))]


def draw_plant(path: Path, plant: type[Plant]) -> None:
    """Write the block diagram to a .svg, .png or .pdf file; `HjcampError` where that fails."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from hjcamp.storage import whole_file

    figure = Figure()
    FigureCanvasAgg(figure)
    paint_plant(figure, plant)
    form = path.suffix.lstrip(".")
    with whole_file(path) as stream:
        figure.savefig(stream, format=form, dpi=150)


def paint_plant(figure: Any, plant: type[Plant]) -> None:
    """Fill a figure with the block diagram, and give it the size that it needs."""
    vocabulary = read_vocabulary(plant)
    ports = dict(vocabulary.ports)
    direct, through = links(vocabulary)
    places: dict[str, tuple[float, float]] = {}
    for number, column in enumerate(columns(ports, direct)):
        for row, name in enumerate(column):
            places[name] = (number * STEP[0], ((len(column) - 1) / 2 - row) * STEP[1])
    width = max((x for x, _ in places.values()), default=0.0) + BOX[0] + 0.8
    heights = [y for _, y in places.values()] or [0.0]
    height = max(heights) - min(heights) + BOX[1] + 1.6
    figure.set_size_inches(max(width, 4.0), max(height, 2.0))
    axes: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(-BOX[0] / 2 - 0.4, width - BOX[0] / 2 - 0.4)
    axes.set_ylim(min(heights) - BOX[1] / 2 - 0.4, max(heights) + BOX[1] / 2 + 0.8)
    axes.set_title(f"{plant.name}: {plant.sentence()}", fontsize=9, color=INK, y=0.93)
    for pairs, style, bend in ((direct, "-", 0.0), (through, (0, (4, 2)), 0.28)):
        for source, target in sorted(pairs):
            _arrow(axes, places[source], places[target], style, bend)
    for name, (x, y) in places.items():
        _box(axes, ports[name], x, y)


def _box(axes: Any, port: Port, x: float, y: float) -> None:
    from matplotlib.patches import FancyBboxPatch

    width, height = BOX
    shape = FancyBboxPatch(
        (x - width / 2, y - height / 2), width, height, boxstyle="round,pad=0.02,rounding_size=0.08",
        facecolor="white", edgecolor=COLOURS[port.kind], linewidth=1.6, zorder=3,
    )  # fmt: skip
    axes.add_patch(shape)
    axes.text(x, y + 0.11, port.name, ha="center", va="center", fontsize=9, color=INK, zorder=4)
    axes.text(x, y - 0.16, port.kind, ha="center", va="center", fontsize=7, color=COLOURS[port.kind], zorder=4)


def _arrow(axes: Any, source: tuple[float, float], target: tuple[float, float], style: Any, bend: float) -> None:
    from matplotlib.patches import FancyArrowPatch

    forward = target[0] > source[0]
    begin = (source[0] + (BOX[0] / 2 if forward else 0.0), source[1] + (0.0 if forward else BOX[1] / 2))
    end = (target[0] - (BOX[0] / 2 if forward else 0.0), target[1] + (0.0 if forward else BOX[1] / 2))
    arrow = FancyArrowPatch(
        begin, end, arrowstyle="-|>", mutation_scale=10, color=INK, linewidth=0.9, linestyle=style, shrinkA=1, shrinkB=2,
        connectionstyle=f"arc3,rad={bend if not forward else bend / 2}", zorder=2,
    )  # fmt: skip
    axes.add_patch(arrow)
