"""The noise of a sensor, by its readings alone: the step of a counter, and what no motion explains."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.noise import step_of, white_noise

Array = NDArray[np.float64]
BANDS = 8
# A band's mean is known from the median of its L lines to 1.2 / sqrt(L) of itself; three times that is no chance.
MEDIAN_ERROR, BEYOND_CHANCE = 1.2, 3.0
# Of this order a difference hardly holds motion of more than six samples a period, whatever noise it holds.
ORDER = 8
# Of the readings' spread: what is smaller is no noise that an analysis could see.
LEAST = 1e-6


def noise_of(values: Array, step: float | None = None) -> float:
    r"""Return the standard deviation of a sensor's noise, by its readings (n,) and its ``step``, which they tell unless given.

    The larger of a counter's :math:`c / \sqrt{12}` with its step c, and what is white. That is the median of the absolute
    third differences over :math:`0.6745 \sqrt{20}`, which slow motion hardly raises (Gasser, Sroka & Jennen-Steinmetz 1986,
    doi:10.1093/biomet/73.3.625), or where it is certainly less the quietest eighth of the spectrum: motion of a few samples a
    period leaves that alone. Never below a millionth of the readings' spread.
    """
    step = step_of(values) if step is None else step
    least = LEAST * float(np.std(values)) + 1e-300
    thirds = white_noise(values, step)
    quiet, error = _quietest_band(values)
    white = quiet if quiet * (1.0 + BEYOND_CHANCE * error) < thirds else thirds
    return max(step / math.sqrt(12.0), white, least)


def without_passed(values: Array, inputs: Array, most: int) -> Array:
    """Return readings (n,) without what inputs (n, k) pass on to them at once, or up to ``most`` samples later.

    By least squares over third differences, which hold little of a slow motion. What reads an input at once (the voltage of a cell
    under a current) leaps with it, and no look at the readings alone tells leaps from noise. Only samples that were are taken: a
    controller may have a reading's noise in what it commands from then on.
    """
    late = [np.concatenate([inputs[:1].repeat(k, axis=0), inputs[: len(inputs) - k]]) for k in range(most + 1)]
    columns = np.concatenate(late, axis=1)
    weights = np.linalg.lstsq(np.diff(columns, 3, axis=0), np.diff(values, 3), rcond=None)[0]
    return np.asarray(values - columns @ weights)


def noise_beyond(values: Array, step: float) -> float:
    """Return the standard deviation of white noise that readings (n,) certainly have next to the ``step`` of a counter; 0 where none.

    The lesser of the median of the absolute eighth differences and the quietest eighth of the spectrum, less its error: a kink of the
    motion shows in the one alone, rounding of an even motion in the other.
    """
    size = 0.6745 * math.sqrt(math.comb(2 * ORDER, ORDER))
    eighths = float(np.median(np.abs(np.diff(values, ORDER)))) / size
    quiet, error = _quietest_band(values)
    white = min(eighths, quiet / (1.0 + BEYOND_CHANCE * error))
    return math.sqrt(max(white**2 - step**2 / 12.0, 0.0)) if white > LEAST * float(np.std(values)) else 0.0


def _quietest_band(values: Array) -> tuple[float, float]:
    """Return the white noise (standard deviation) that the quietest band of the spectrum allows, and its relative error."""
    window = np.hanning(len(values))
    power = np.abs(np.fft.rfft((values - values.mean()) * window))[1:] ** 2 / np.sum(window**2)
    bands = np.array_split(power, BANDS)
    lines = len(bands[-1])
    # the median of an exponential distribution is ln 2 of its mean; the window makes two lines tell as much as one
    least = min(float(np.median(band)) for band in bands) / math.log(2.0)
    return math.sqrt(least), 0.5 * MEDIAN_ERROR * math.sqrt(2.0 / lines)
