"""Readings that a sensor or its logger got wrong: that jump out and back, stand still, wrap around, or stand for none."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
Places = NDArray[np.intp]
# So few readings of a test, so few in a row, are ones that went wrong; more of them are the column.
FEW, ROW = 0.01, 10
# A jump is at least so many times the largest step that is none. White noise would need a reading beyond ten standard deviations.
TIMES = 2.0
FEWEST = 50
# Equal readings in so long a row come by chance in one log of twenty at most.
CHANCE = 1.0 / 20.0
SHORTEST = 3  # steps of a row that stands still
# Ten readings of white noise differ by so many of its median second differences once in 10 000 times.
MOVED = 3.4
NONE = np.array([], dtype=np.intp)


def spikes(values: Array) -> Places:
    """Return the places of the readings (n,) that jump out and back within ten readings, by steps that no others come near.

    Every step that is at least twice as large as all smaller ones has to be part of such a spike, or lie so near the first
    or the last reading that those before or behind it are wrong: a column that also jumps and stays, as one that is set to
    0, has none. Nothing is found among fewer than 50 readings, nor more than 1 % of them.
    """
    steps = np.diff(values)
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return NONE
    most = max(int(FEW * len(values)), 1)
    order = np.argsort(-np.abs(steps), kind="stable")[: 2 * most + 1]
    sizes = np.abs(steps[order])
    found = NONE
    for k in np.flatnonzero(sizes[:-1] > TIMES * sizes[1:]) + 1:
        places = _between(values, np.sort(order[:k]), sizes[k])
        found = places if 0 < len(places) <= most else found
    return found


def _between(values: Array, jumps: Places, usual: float) -> Places:
    """Return the readings between each jump and the one back, or the end; none where a jump has none back."""
    last = len(values) - 1
    ways = [[*jumps]]
    # a first or last reading that is wrong has one jump
    if jumps[0] < ROW:
        ways.append([-1, *jumps])
    if last - jumps[-1] <= ROW:
        ways += [[*way, last] for way in ways]
    for way in ways:
        pairs = list(zip(way[::2], way[1::2], strict=False))
        if len(way) % 2 == 0 and all(
            back - out <= ROW and (out < 0 or back == last or abs(values[back + 1] - values[out]) <= usual * (back + 1 - out))
            for out, back in pairs
        ):
            # what is left between the readings around a spike are ordinary steps
            return np.concatenate([np.arange(out + 1, back + 1) for out, back in pairs])
    return NONE


def freezes(values: Array) -> list[tuple[int, int]]:
    """Return the first and last place of readings (n,) that stay exactly as they were although the rest shows that they cannot.

    So long a row of equal readings comes by chance in one log of twenty at most, by how often two neighbours are equal elsewhere;
    and it ends by a jump at least twice as large as any other step, or noise shows in all readings around it.
    """
    steps = np.diff(values)
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return []
    edges = np.flatnonzero(np.diff(np.concatenate([[False], steps == 0.0, [False]]).astype(int))).reshape(-1, 2)
    rows = [(int(first), int(end)) for first, end in edges if end - first > SHORTEST]
    if not rows:
        return []
    places = spikes(values)
    spiked, still = np.zeros(len(steps) + 1, bool), np.zeros(len(steps) + 1, bool)
    spiked[places] = spiked[np.maximum(places - 1, 0)] = True
    for first, end in rows:
        still[first : end + 1] = True
    others = steps[~(spiked | still)[:-1]]
    if len(others) < FEWEST:
        return []
    share, largest, noisy = (
        (np.count_nonzero(others == 0.0) + 1) / (len(others) + 1),
        float(np.abs(others).max()),
        _alternates(others),
    )
    return [
        (first, end)
        for first, end in rows
        if len(values) * share ** (end - first) < CHANCE
        and (noisy or (end < len(steps) and not spiked[end] and abs(steps[end]) > TIMES * largest))
    ]


def _alternates(steps: Array) -> bool:
    """Whether steps change their sign as those of noise do, of which two in three are such, and hardly any is 0."""
    moved = np.sign(steps[steps != 0.0])
    return len(moved) >= FEWEST and len(moved) > 0.95 * len(steps) and float(np.mean(moved[1:] != moved[:-1])) > 0.5


def wraps(values: Array) -> Places:
    """Return the places before which readings (n,) begin again at the other end of their range, as a counter's or an angle's.

    The jumps are all about as large as the whole range, twice as large as any other step at least, from near one end to near the
    other, and the readings go on in the direction that they had, against the jump.
    """
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return NONE
    rows = np.arange(len(values))
    good = np.delete(rows, spikes(values))
    steps = np.diff(np.interp(rows, good, values[good]))
    span = float(np.ptp(values[good]))
    jumps = np.flatnonzero(np.abs(steps) > 0.5 * span)
    others = np.delete(np.abs(steps), jumps)
    if not len(jumps) or len(jumps) > len(values) // 4 or not others.size or np.abs(steps[jumps]).min() < TIMES * others.max():
        return NONE
    near = span - np.abs(steps[jumps]) <= TIMES * others.max()
    smooth = steps.copy()
    smooth[jumps] = 0.0
    least = MOVED * float(np.median(np.abs(np.diff(smooth))))
    before, behind = (
        -np.sign(steps[jumps]) * [np.sum(smooth[max(jump - ROW + way, 0) : jump + way]) for jump in jumps] > least
        for way in (0, ROW + 1)
    )
    # a reading that swings about the place of the jump turns there now and then
    return jumps + 1 if near.all() and np.mean(before) >= 0.5 and np.mean(behind) >= 0.5 else NONE


def no_readings(values: Array) -> Places:
    """Return the places of one value, repeated exactly, that lies far outside of all other readings (n,): it stands for none.

    What is between it and the others is at least twice their whole range, and none of them ever stands there.
    """
    if len(values) < FEWEST or not np.all(np.isfinite(values)):
        return NONE
    for end in (float(values.min()), float(values.max())):
        places = np.flatnonzero(values == end)
        rest = np.delete(values, places)
        if 1 < len(places) < len(values) // 2 and np.ptp(rest) > 0.0 and np.abs(rest - end).min() > TIMES * np.ptp(rest):
            return places
    return NONE
