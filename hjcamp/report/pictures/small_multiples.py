"""Small pictures of all conditions: what was wanted and what was measured, each a way to its condition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from html import escape

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.runs.followed import FOLLOWED, WANTED
from hjcamp.report.runs.spread import Condition, Spread, stretches
from hjcamp.report.wording.names import readable

Array = NDArray[np.float64]
WIDE, HIGH, MOST_POINTS = 150.0, 54.0, 150
#: An area of fewer points, each of which covers most of a period, has no teeth.
AREA_POINTS = 38


def small_multiples(conditions: Sequence[Condition], anchors: Mapping[str, str], said: Mapping[str, str]) -> str:
    """Return one small picture for each condition as HTML; a click leads to its ``anchors``, ``said`` stands below."""
    return (
        '<div class="small">\n'
        + "\n".join(_small(one, anchors[one.name], said.get(one.name, "")) for one in conditions)
        + "\n</div>"
    )


def _small(condition: Condition, anchor: str, said: str) -> str:
    names = [name for name in (WANTED, FOLLOWED) if name in condition.signals] or list(condition.signals)[:1]
    curves = {
        name: replace(one, mean=condition.lines(name)[0], single=())
        for name in names
        if len((one := condition.signals[name]).mean)
    }
    ends = [float(end) for one in curves.values() for end in (one.lowest.min(), one.highest.max())]
    low, high = (min(ends), max(ends)) if ends else (0.0, 1.0)
    lines = "".join(drawn(one, low, high, "wanted" if name == WANTED else "seen") for name, one in curves.items())
    shown = escape(readable(condition.name))
    return (
        f'<a href="#{anchor}"><svg viewBox="0 0 {WIDE:g} {HIGH:g}" role="img" aria-label="{shown}">{lines}</svg>'
        f"<span>{shown}</span><small>{escape(said)}</small></a>"
    )


def few_points(signal: Spread, most: int) -> Spread:
    """Return a signal in at most so many points: mean, lowest and highest of each equal stretch."""
    size = max(1, -(-len(signal.mean) // most))
    return Spread(
        stretches(signal.mean, size).mean(axis=-1),
        stretches(signal.lowest, size).min(axis=-1),
        stretches(signal.highest, size).max(axis=-1),
    )


def drawn(signal: Spread, low: float, high: float, kind: str) -> str:
    """Return a signal as a line, or as the area between its ends where it swings too fast for one."""
    line = few_points(signal, MOST_POINTS)
    if line.swings(high - low):
        area = few_points(signal, AREA_POINTS)
        outline = [*_points(area.highest, low, high), *_points(area.lowest, low, high)[::-1]]
        return f'<polygon points="{" ".join(outline)}" class="{kind}"/>'
    return f'<polyline points="{" ".join(_points(line.mean, low, high))}" class="{kind}"/>'


def _points(values: Array, low: float, high: float) -> list[str]:
    across = np.linspace(1.0, WIDE - 1.0, len(values))
    up = HIGH - 2.0 - (values - low) / ((high - low) or 1.0) * (HIGH - 4.0)
    return [f"{x:.1f},{y:.1f}" for x, y in zip(across, up, strict=True)]
