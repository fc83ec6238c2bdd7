"""The block diagram of a plant: its places, and which of them each one depends on, directly or through a state."""

from __future__ import annotations

import re
import textwrap
from dataclasses import replace
from pathlib import Path
from typing import Any

from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import KINDS, Port
from hjcamp.model.language.vocabulary import Vocabulary, read_vocabulary
from hjcamp.storage import whole_file

INK = "#1b1f24"
#: The kinds of places in the order in which a drive has them.
COLOURS = {
    "actuator": "#0072b2", "transmission": "#e69f00", "path": "#56b4e9", "store": "#009e73", "contact": "#d55e00",
    "body": "#cc79a7", "sensor": "#555b63",
}  # fmt: skip
#: What a place computes besides its slots.
RESULTS = {"store": ("level",), "body": ("push", "acceleration")}
BOX = (1.7, 0.62)
STEP = (2.5, 1.15)
LETTERS_PER_INCH = 13
EVERYWHERE = ("u_direction", "u_time")
WORD = re.compile(r"\b[A-Za-z_]\w*")


def links(vocabulary: Vocabulary) -> tuple[set[tuple[str, str]], set[tuple[str, str]]]:
    """Return pairs (from, to) of places: what one computes from another's lines, and from a state that another drives."""
    behind = _behind(vocabulary)
    owner, reads = _owners(vocabulary, behind)
    direct: set[tuple[str, str]] = set()
    through: set[tuple[str, str]] = set()
    used = [(target, behind[line]) for line, target in owner.items()] + list(reads.items())
    for target, words in used:
        lines = {word for word in words if not word.startswith("s_")}
        direct |= {(source, target) for source in _sources(lines, behind, owner)[0] if source != target}
        through |= {(source, target) for source in _sources(words - lines, behind, owner)[0] if source != target}
    return direct, through - direct


def _behind(vocabulary: Vocabulary) -> dict[str, set[str]]:
    """Return the words of each line, and of the rate of each state under its name in the lines."""
    return {
        f"s_{one.target}" if one.mark == "rate" else one.target: set(WORD.findall(one.expression))
        for one in vocabulary.statements
    }


def _owners(vocabulary: Vocabulary, behind: dict[str, set[str]]) -> tuple[dict[str, str], dict[str, set[str]]]:
    """Return line -> the place that computes it, and for each place that was declared by names the lines that it reads.

    An element of the equations has lines of its own name. A place declared by names has its slots, and what moves or
    fills it: a slot that belongs to its neighbour (`loss_below`) is left to that.
    """
    owner: dict[str, str] = {}
    reads: dict[str, set[str]] = {}
    for port in vocabulary.ports.values():
        own = [line for line in vocabulary.signals if line == port.name or line.startswith(f"{port.name}_")]
        if own:
            owner |= dict.fromkeys(own, port.name)
            continue
        made = {*KINDS[port.kind].slots, *RESULTS.get(port.kind, ())} - {"loss_below"}
        owner |= {name: port.name for local, name in port.names.items() if local in made and name in vocabulary.signals}
        words = {name for local, name in port.names.items() if local not in made and local != "loss_below"}
        reads[port.name] = {name if name in behind else f"s_{name}" for name in words} & behind.keys()
    return owner, reads


def _sources(words: set[str], behind: dict[str, set[str]], owner: dict[str, str]) -> tuple[set[str], set[str]]:
    """Return the places and the inputs that these words come from, through lines and states that belong to none."""
    found: set[str] = set()
    inputs: set[str] = set()
    seen: set[str] = set()
    left = sorted(words)
    while left:
        word = left.pop()
        if word in owner:
            found.add(owner[word])
        elif word.startswith("u_") and word not in EVERYWHERE:
            inputs.add(word)
        elif word not in seen:
            left += sorted(behind.get(word, ()))
        seen.add(word)
    return found, inputs


def without_partitions(plant: type[Plant]) -> Vocabulary:
    """Return what a plant offers without the places at which nothing is unless an effect puts it there (a leaking partition)."""
    found = read_vocabulary(plant)
    return replace(found, ports={name: port for name, port in found.ports.items() if port.kind in COLOURS})


def columns(vocabulary: Vocabulary, pairs: set[tuple[str, str]]) -> list[list[str]]:
    """Return the places in columns by their distance from where the plant's inputs come in; sensors stand below others."""
    ports = vocabulary.ports
    depth = dict.fromkeys(_first(vocabulary), 0)
    level = list(depth)
    while level:
        following = [target for source, target in sorted(pairs) if source in level and target not in depth]
        level = list(dict.fromkeys(following))
        depth |= dict.fromkeys(level, max(depth.values()) + 1)
    depth = {name: depth.get(name, 0) for name in ports}
    order = sorted(ports, key=lambda name: ports[name].kind == "sensor")
    return [[name for name in order if depth[name] == one] for one in sorted(set(depth.values()))]


def _first(vocabulary: Vocabulary) -> list[str]:
    """Return the places at which an input acts: those of the kind that comes first in a drive."""
    behind = _behind(vocabulary)
    owner, _ = _owners(vocabulary, behind)
    driven: dict[str, list[str]] = {}
    for line, name in owner.items():
        if _sources(behind[line], behind, owner)[1]:
            driven.setdefault(vocabulary.ports[name].kind, []).append(name)
    return next((driven[kind] for kind in COLOURS if kind in driven), list(vocabulary.ports)[:1])


def draw_plant(path: Path, plant: type[Plant]) -> None:
    """Write the block diagram to a .svg, .png or .pdf file; `HjcampError` where that fails."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from hjcamp.report.pictures.conditions import own_settings

    form = path.suffix.lstrip(".")
    with own_settings({}), whole_file(path) as stream:
        figure = Figure()
        FigureCanvasAgg(figure)
        paint_plant(figure, plant)
        figure.savefig(stream, format=form, dpi=150)


def paint_plant(figure: Any, plant: type[Plant]) -> None:
    """Fill a figure with the block diagram, and give it the size that it needs."""
    vocabulary = without_partitions(plant)
    ports = dict(vocabulary.ports)
    direct, through = links(vocabulary)
    places: dict[str, tuple[float, float]] = {}
    for number, column in enumerate(columns(vocabulary, direct | through)):
        for row, name in enumerate(column):
            places[name] = (number * STEP[0], ((len(column) - 1) / 2 - row) * STEP[1])
    width = max((x for x, _ in places.values()), default=0.0) + BOX[0] + 0.8
    heights = [y for _, y in places.values()] or [0.0]
    height = max(heights) - min(heights) + BOX[1] + 1.6
    figure.set_size_inches(max(width, 4.0), max(height, 2.0))
    axes: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(-BOX[0] / 2 - 0.4, width - BOX[0] / 2 - 0.4)
    axes.set_ylim(min(heights) - BOX[1] / 2 - 0.4, max(heights) + BOX[1] / 2 + 0.9)
    title = textwrap.fill(f"{plant.name}: {plant.sentence()}", round(max(width, 4.0) * LETTERS_PER_INCH))
    axes.text(0.5, 0.98, title, transform=axes.transAxes, ha="center", va="top", fontsize=9, color=INK)
    told = "solid: computed from the other's lines; dashed: through a state"
    axes.text(0.99, 0.02, told, transform=axes.transAxes, ha="right", va="bottom", fontsize=7, color=INK)
    pairs = direct | through
    for source, target in sorted(pairs):
        both = (target, source) in pairs
        if not both or (places[source][0], -places[source][1]) < (places[target][0], -places[target][1]):
            solid = (source, target) in direct or (both and (target, source) in direct)
            _arrow(axes, places[source], places[target], "-" if solid else (0, (4, 2)), both)
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


def _arrow(axes: Any, source: tuple[float, float], target: tuple[float, float], style: Any, both: bool) -> None:
    """Draw an arrow from box to box, with a head at each end where each depends on the other."""
    from matplotlib.patches import FancyArrowPatch

    half, tall = BOX[0] / 2, BOX[1] / 2
    if source[0] == target[0]:
        down = tall if source[1] > target[1] else -tall
        begin, end, bend = (source[0], source[1] - down), (target[0], target[1] + down), 0.0
    elif target[0] > source[0]:
        begin, end, bend = (source[0] + half, source[1]), (target[0] - half, target[1]), 0.0
    else:
        begin, end, bend = (source[0], source[1] + tall), (target[0], target[1] + tall), 0.28
    arrow = FancyArrowPatch(
        begin, end, arrowstyle="<|-|>" if both else "-|>", mutation_scale=10, color=INK, linewidth=0.9, linestyle=style,
        shrinkA=2, shrinkB=2, connectionstyle=f"arc3,rad={bend}", zorder=2,
    )  # fmt: skip
    axes.add_patch(arrow)
