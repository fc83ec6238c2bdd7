"""Small pictures of all conditions: what was wanted and what was measured, each a way to its condition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.spread import Condition

Array = NDArray[np.float64]
WIDE, HIGH, MOST_POINTS = 150.0, 54.0, 75
WANTED, MEASURED = "reference_deg", "arm_deg"


def small_multiples(conditions: Sequence[Condition], anchors: Mapping[str, str], said: Mapping[str, str]) -> str:
    """Return one small picture for each condition as HTML; a click leads to its ``anchors``, ``said`` stands below."""
    return (
        '<div class="small">\n'
        + "\n".join(_small(one, anchors[one.name], said.get(one.name, "")) for one in conditions)
        + "\n</div>"
    )


def _small(condition: Condition, anchor: str, said: str) -> str:
    names = [name for name in (WANTED, MEASURED) if name in condition.signals] or list(condition.signals)[:1]
    curves = [condition.signals[name].mean for name in names]
    low, high = (
        (f(one) for f, one in ((np.min, np.concatenate(curves)), (np.max, np.concatenate(curves))))
        if curves and len(curves[0])
        else (0.0, 1.0)
    )
    lines = "".join(
        f'<polyline points="{_points(curve, float(low), float(high))}" class="{"wanted" if name == WANTED else "seen"}"/>'
        for name, curve in zip(names, curves, strict=True)
    )
    return (
        f'<a href="#{anchor}"><svg viewBox="0 0 {WIDE:g} {HIGH:g}" role="img" aria-label="{escape(condition.name)}">{lines}</svg>'
        f"<span>{escape(condition.name)}</span><small>{escape(said)}</small></a>"
    )


def _points(values: Array, low: float, high: float) -> str:
    if not len(values):
        return ""
    picked = values[:: max(1, -(-len(values) // MOST_POINTS))]
    across = np.linspace(1.0, WIDE - 1.0, len(picked))
    up = HIGH - 2.0 - (picked - low) / ((high - low) or 1.0) * (HIGH - 4.0)
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, up, strict=True))
