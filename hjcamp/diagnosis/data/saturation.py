r"""The ends of a sensor: its largest or smallest reading, repeated exactly in a row although its noise shows elsewhere.

A reading with white noise of standard deviation w beyond the step q of its counter equals the one before with a probability of

.. math:: p \le \operatorname{erf}\Bigl(\frac{q}{2 \sqrt{2}\,w}\Bigr)

at most: a cell of width q about its mean. Of n readings a row of r equal ones begins somewhere with at most :math:`n\,p^{r-1}`.
Where that, for both ends of all sensors, is below the level, the row is no chance: there the sensor ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.sensor_noise import noise_beyond
from hjcamp.diagnosis.levels import ENDS
from hjcamp.records.noise import SAME

Array = NDArray[np.float64]
# Fewer readings within the ends say nothing of noise.
FEWEST = 64


def ends_of(tests: Sequence[Array], step: float, sensors: int = 1) -> tuple[float, float]:
    """Return the lowest and the highest value that a sensor can show, by its readings (n,) in each test; infinite where none is seen.

    ``step`` is that of its counter, 0 where none shows; ``sensors`` is how many are looked at.
    """
    low, high = min(float(one.min()) for one in tests), max(float(one.max()) for one in tests)
    chance = _chance_of_equal(tests, step, low, high)
    if chance >= 1.0:
        return -math.inf, math.inf
    readings = sum(len(one) for one in tests)
    needed = 1.0 + math.log(ENDS / (2 * sensors * readings)) / math.log(chance)
    return (
        low if longest_row(tests, low) >= needed else -math.inf,
        high if longest_row(tests, high) >= needed else math.inf,
    )


def longest_row(tests: Sequence[Array], value: float) -> int:
    """Return how many readings (n,) in a row are this value at most, without a row with which a test begins: it may be at rest."""
    longest = 0
    for one in tests:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], one == value, [False]]).astype(int)))
        rows = [(first, last) for first, last in edges.reshape(-1, 2) if first > 0]
        longest = max([longest, *(int(last - first) for first, last in rows)])
    return longest


def within(readings: Array, low: float, high: float) -> Array:
    """Return the readings (n,) between the ends of a sensor; all of them where these are too few."""
    found = readings[(readings > low) & (readings < high)]
    return found if len(found) >= FEWEST else readings


def _least_difference(readings: Array) -> float:
    gaps = np.diff(np.unique(readings))
    return float(min(gaps[gaps > SAME * np.ptp(readings)], default=0.0))


def _chance_of_equal(tests: Sequence[Array], step: float, low: float, high: float) -> float:
    """Return the largest probability of a reading that equals the one before: by step and noise, and as often as it is seen."""
    # where no step is told, it is no larger than the least difference of two readings
    step = step or _least_difference(np.concatenate(list(tests)))
    noise, equal, pairs = [], 0, 0
    for one in tests:
        inside = (one > low) & (one < high)
        both = inside[1:] & inside[:-1]
        equal, pairs = equal + int(np.sum(both & (np.diff(one) == 0.0))), pairs + int(both.sum())
        if inside.sum() >= FEWEST:
            noise.append(noise_beyond(one[inside], step))
    white = float(np.median(noise)) if noise else 0.0
    if white <= 0.0:
        return 1.0
    return max(math.erf(step / (2.0 * math.sqrt(2.0) * white)), (1 + equal) / (1 + pairs))
