"""What readings say of the sensor that made them: the step of a counter, and noise that no slow motion explains."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEVEL = 0.05
# Readings are whole counts but for how they were printed. A gap is within 0.1 of whole smallest ones by chance in one case of five:
# two gaps that are, beside the two that tell the step, is less than chance allows a claim.
WHOLE, NEARLY_ALL = 0.1, 0.99
FEWEST = 2 + math.ceil(math.log(LEVEL) / math.log(2.0 * WHOLE))
SMALL = 5.5
# A difference of more steps counts as one of so many: where the median lies, a step is nothing then.
MOST_STEPS = 10**6
# Of the readings' range: readings that differ by less are the same.
SAME = 1e-9


def white_noise(values: Array, step: float = 0.0) -> float:
    r"""Return the standard deviation of white noise by the median of the absolute third differences over :math:`0.6745 \sqrt{20}`.

    Slow motion hardly raises it (Gasser, Sroka & Jennen-Steinmetz 1986, doi:10.1093/biomet/73.3.625). Differences of counts are whole
    steps: each stands for the half ``step`` to both sides of it (median of grouped data). 0 for fewer than 4 readings.
    """
    if len(values) < 4:
        return 0.0
    found = np.abs(np.diff(values, 3))
    return (_grouped_median(found, step) if step > 0.0 else float(np.median(found))) / (0.6745 * math.sqrt(20.0))


def _grouped_median(values: Array, step: float) -> float:
    """Return the median of values (n,), none negative, that are counted in steps."""
    counts = np.bincount(np.minimum(np.round(values / step), MOST_STEPS).astype(int))
    below = np.concatenate([[0], np.cumsum(counts)])
    cell = int(np.searchsorted(below[1:], 0.5 * len(values)))
    low, high = max(cell - 0.5, 0.0), cell + 0.5
    return float(step * (low + (high - low) * (0.5 * len(values) - below[cell]) / counts[cell]))


def step_of(values: Array) -> float:
    """Return the step of which all readings (n,) are whole multiples about one of them; 0 where there is none."""
    gaps = np.diff(np.unique(values))
    gaps = gaps[gaps > SAME * (np.ptp(values) + 1e-300)]
    if not len(gaps):
        return 0.0
    small = gaps[gaps < SMALL * gaps.min()]
    step = float(np.sum(small) / np.sum(np.round(small / gaps.min())))
    counts = gaps / step
    whole = float(np.mean(np.abs(counts - np.round(counts)) < WHOLE))
    return step if len(gaps) >= FEWEST and whole > NEARLY_ALL else 0.0
