"""What a counter shows of a path, and what its readings tell of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def counted_in_steps(readings: Array, steps: Array, phases: Array) -> Array:
    """Return readings (n, sensors) in whole steps (sensors,), 0 where none counts, that begin at phases (sensors,) of one step."""
    size = np.where(steps > 0.0, steps, 1.0)
    return np.where(steps > 0.0, (np.round(readings / size + phases) - phases) * size, readings)


def between_counts(readings: Array) -> Array:
    """Return the path (n,) of a counter: half way where its readings (n,) change, straight from there to the next change."""
    changes = np.flatnonzero(np.diff(readings))
    at = np.concatenate([[0.0], changes + 0.5, [len(readings) - 1.0]])
    values = np.concatenate([readings[:1], 0.5 * (readings[changes] + readings[changes + 1]), readings[-1:]])
    return np.asarray(np.interp(np.arange(len(readings)), at, values))
