"""What of the motion tells most about what a model leaves: quantities taken one by one, each beside those before it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import motion_of, moves
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.estimation.likelihood import whitener
from hjcamp.diagnosis.levels import DELTA
from hjcamp.diagnosis.validation.kernel_regression import regressed, spread_over, with_before

Array = NDArray[np.float64]
ORDERS = ("", "rate of ", "curvature of ")
MOST_WINDOWS = 300
MOST_NAMED = 3


def leading(layout: Layout, features: Array, blocks: NDArray[np.int64], readings: Array) -> list[str]:
    """Return up to three quantities, the one that tells most first; the last of them takes a tenth of what all take at least.

    A quantity is the mean, the slope or the curvature of a channel or an input in a window, or all three of them in the window before.
    """
    rows = spread_over(len(features), MOST_WINDOWS)
    groups = {name: columns[rows] for name, columns in _quantities(layout, readings).items()}
    values, parts = (features @ whitener(features))[rows], blocks[rows]

    def left(names: list[str]) -> float:
        found = regressed([np.hstack([groups[name] for name in names])], values, parts)
        return float(np.mean(found**2) / np.mean(values**2))

    found: list[str] = []
    now = 1.0
    while len(found) < MOST_NAMED:
        tried = {name: left([*found, name]) for name in groups if name not in found}
        best = min(tried, key=lambda name: tried[name])
        if now - tried[best] <= DELTA * (1.0 - tried[best]):
            break
        found.append(best)
        now = tried[best]
    return found


def _quantities(layout: Layout, readings: Array) -> dict[str, Array]:
    """Return the columns of the motion (windows, m) by name."""
    moving = [name for name, column in zip(layout.names, layout.inputs.T, strict=True) if np.std(column) > 0.0]
    motion, told = motion_of(layout, readings), moves(layout)
    both = with_before(layout, motion)
    m = motion.shape[1]
    per = m // (len(layout.measured.sensors) + len(moving))
    found: dict[str, Array] = {}
    shown = [
        one.quantity if one.quantity not in layout.names else f"measured {one.quantity}" for one in layout.measured.sensors
    ]
    for place, name in enumerate([*shown, *moving]):
        own = slice(per * place, per * (place + 1))
        found |= {order + name: motion[:, own][:, k : k + 1] for k, order in enumerate(ORDERS[:per]) if told[own][k]}
        if told[own].any():
            found[f"{name} before"] = both[:, m:][:, own][:, told[own]]
    return found
