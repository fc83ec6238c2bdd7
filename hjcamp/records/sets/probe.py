"""A few readings from the middle of a column, by which a copy of it is found in another log, wherever it begins there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.noise import step_of
from hjcamp.records.sets.course import ROUNDING, Array

PROBES = 16


class Probe(NamedTuple):
    """Readings (k,) of a column, and the samples (k,) at which it has them."""

    places: NDArray[np.intp]
    readings: Array

    def found_in(self, values: Array, within: float) -> NDArray[np.intp]:
        """Return the samples of ``values`` (m,) at which a copy has the first of the readings, all within ``within``."""
        found: NDArray[np.intp] = np.arange(len(values))
        for ahead, reading in zip(self.places - self.places[0], self.readings, strict=True):
            found = found[found + int(ahead) < len(values)]
            found = found[np.abs(values[found + int(ahead)] - reading) <= within]
        return found


def probe_of(values: Array) -> Probe:
    """Return readings from before the middle of a column (n,)."""
    middle = len(values) // 2
    places = np.unique(np.linspace(max(middle - len(values) // 8, 0), middle, PROBES).astype(int))
    return Probe(places, values[places])


def rounding(one: Array, step: float) -> float:
    """Return by how much a column (n,) and one of some ``step`` may differ that are printed from one: half the coarser digit."""
    return max(0.5 * max(step_of(one), step), ROUNDING * float(np.std(one))) * (1.0 + ROUNDING)
