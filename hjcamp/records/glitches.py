"""Readings that a sensor or its logger got wrong: some that jump out and back, and some that stay as they were."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
# So few readings of a test, so few in a row, are single ones that went wrong; more of them are the column.
FEW, ROW = 0.01, 3
# A jump is at least so many times the largest step that is none. White noise would need a reading beyond ten standard deviations.
TIMES = 2.0
FEWEST = 50


def spikes(values: Array) -> NDArray[np.intp]:
    """Return the places of the readings (n,) that jump out and back within three readings, by steps that no others come near.

    Every step that is at least twice as large as all smaller ones has to be part of such a spike: a column that also jumps and
    stays, as one that is set to 0, has none. Nothing is found among fewer than 50 readings, nor more than 1 % of them.
    """
    steps = np.diff(values)
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return np.array([], dtype=np.intp)
    most = int(FEW * len(values))
    order = np.argsort(-np.abs(steps), kind="stable")[: 2 * most + 1]
    sizes = np.abs(steps[order])
    found = np.array([], dtype=np.intp)
    for k in np.flatnonzero(sizes[:-1] > TIMES * sizes[1:]) + 1:
        places = _between(values, np.sort(order[:k]), sizes[k])
        found = places if 0 < len(places) <= most else found
    return found


def told_spikes(name: str, places: NDArray[np.intp], values: Array, times: Array, unit: str) -> str:
    """Return in words that the readings at these places, one at least, jump out and back."""
    at = int(places[0])
    number = "a reading jumps" if len(places) == 1 else f"{len(places)} readings jump"
    first = f"{values[at - 1]:.4g}, then {values[at]:.4g} {unit} at {times[at]:.6g} s"
    return f"'{name}': {number} out and back by far more than any other step ({'first ' if len(places) > 1 else ''}{first})"


def _between(values: Array, jumps: NDArray[np.intp], usual: float) -> NDArray[np.intp]:
    """Return the readings between each jump and the one back; none where a jump has none back."""
    if len(jumps) % 2 or any(after - before > ROW for before, after in zip(jumps[::2], jumps[1::2], strict=True)):
        return np.array([], dtype=np.intp)
    found: list[int] = []
    for out, back in zip(jumps[::2], jumps[1::2], strict=True):
        # what is left between the readings around a spike are ordinary steps
        if abs(values[back + 1] - values[out]) > usual * (back + 1 - out):
            return np.array([], dtype=np.intp)
        found += range(out + 1, back + 1)
    return np.array(found, dtype=np.intp)


def frozen(values: Array) -> tuple[int, int] | None:
    """Return the first and last place of readings (n,) that stay exactly as they were and then jump on; None where none do.

    The jump is at least twice as large as any other step, and so long a row of equal readings comes by chance in one log of
    twenty at most, by how often two neighbours are equal elsewhere.
    """
    steps = np.diff(values)
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return None
    sizes = np.abs(steps)
    jump = int(np.argmax(sizes))
    others = np.delete(sizes, jump)
    moved = np.flatnonzero(sizes[:jump])
    first = int(moved[-1]) + 1 if len(moved) else 0
    length = jump - first
    if length <= ROW or not sizes[jump] > TIMES * others.max():
        return None
    elsewhere = len(others) - length
    share = (np.count_nonzero(others == 0.0) - length + 1) / (elsewhere + 1)
    return (first, jump) if len(values) * share**length < 1.0 / 20.0 else None
