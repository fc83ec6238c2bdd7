"""How long the windows are into which tests are cut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import SHORTEST, SHORTEST_OF_ALL, WINDOWS
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.validation.blocks import FEWEST

Array = NDArray[np.float64]
# Four windows in the time after which a reading has little in common with itself.
OF_CORRELATION = 0.25


def width_of(measured: Measured) -> int:
    """Return the samples of a window: a quarter of the readings' correlation time, fewer where tests are short."""
    lengths = [test.samples for test in measured.tests]
    times = [_correlation(test.readings[:, k]) for test in measured.tests for k in range(len(measured.sensors))]
    # each test ends with a rest that belongs to no window
    enough = (
        width for width in range(SHORTEST, SHORTEST_OF_ALL, -1) if sum(length // width for length in lengths) >= 3 * FEWEST
    )
    least = next(enough, SHORTEST_OF_ALL)
    most = max(least, min(sum(lengths) // WINDOWS, min(lengths)))
    return int(np.clip(OF_CORRELATION * np.median(times), least, most))


def _correlation(values: Array) -> int:
    """Return the samples after which the autocorrelation of values (n,) falls to 1/e."""
    centred = values - values.mean()
    size = 2 ** int(np.ceil(np.log2(2 * len(values))))
    power = np.abs(np.fft.rfft(centred, size)) ** 2
    found = np.fft.irfft(power)[: len(values)]
    below = np.flatnonzero(found < found[0] / np.e)
    return int(below[0]) if len(below) and found[0] > 0.0 else len(values)
