"""Stretches of a test in which the pump moves at constant speed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SMOOTHING = 21  # samples of the polynomial that gives the speed
SHORTEST = 40  # samples
SLOWEST = 50.0  # deg/s of the pump motor: 0.14 mm/s
CHANGE = 0.05  # of the speed, over one smoothing length
SHARE = 0.55  # of the way between two turns: a sine is straight for 0.4 of it


class Stroke(NamedTuple):
    """Samples ``start`` to ``stop`` (exclusive) at constant speed; ``speed`` in deg/s of the pump motor, signed."""

    start: int
    stop: int
    speed: float

    @property
    def direction(self) -> float:
        return 1.0 if self.speed > 0 else -1.0


def find_strokes(pump: Array) -> list[Stroke]:
    """Return the constant-speed strokes of a pump (n,) in deg at 1 kHz, in order of time.

    Speed by a local quadratic (Savitzky & Golay 1964, Anal. Chem. 36, 1627); constant where it changes by less than 5 %
    within 20 ms.
    """
    from scipy.signal import savgol_filter

    if len(pump) < 2 * SMOOTHING:
        return []
    speed = savgol_filter(pump, SMOOTHING, 2, deriv=1, delta=1e-3)
    half = SMOOTHING // 2
    change = np.full(len(pump), np.inf)
    change[half:-half] = np.abs(speed[2 * half :] - speed[: -2 * half])
    steady = (change <= CHANGE * np.abs(speed)) & (np.abs(speed) >= SLOWEST)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], steady, [False]]).astype(int)))
    runs = zip(edges[::2], edges[1::2], strict=True)
    # A run is first cut where the speed has drifted: slow curves (a sine) pass the local test piece by piece.
    found = []
    for start, stop in runs:
        middle = float(np.median(speed[start:stop]))
        similar = np.abs(speed[start:stop] - middle) <= CHANGE * abs(middle)
        inner = np.flatnonzero(similar)
        if len(inner) >= max(SHORTEST, 0.8 * (stop - start)):
            stroke = Stroke(int(start + inner[0]), int(start + inner[-1] + 1), middle)
            if _share_of_way(stroke, pump, speed) >= SHARE:
                found.append(stroke)
    return found


def _share_of_way(stroke: Stroke, pump: Array, speed: Array) -> float:
    """Return how much of the way in its direction, at speeds like its own, the stroke is."""
    along = speed * stroke.direction / abs(stroke.speed)
    off = np.flatnonzero((along < 0.1) | (along > 1.0 + 4.0 * CHANGE))
    first = int(off[off < stroke.start].max(initial=-1)) + 1
    last = int(off[off >= stroke.stop].min(initial=len(pump))) - 1
    way = abs(float(pump[last] - pump[first]))
    return abs(float(pump[stroke.stop - 1] - pump[stroke.start])) / way if way > 0 else 0.0
