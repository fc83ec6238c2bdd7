"""A few readings from the middle of a column, by which a copy of it is found in another log, wherever it begins there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.sets.course import ROUNDING, Array, Course

PROBES = 16


class Probe(NamedTuple):
    """Readings (k,) of a column, and the samples (k,) at which it has them."""

    places: NDArray[np.intp]
    readings: Array

    def found_in(self, values: Array, within: float, among: NDArray[np.intp] | None = None) -> NDArray[np.intp]:
        """Return the samples of ``values`` (m,), ``among`` those given, where a copy has the first reading, all within ``within``."""
        found: NDArray[np.intp] = np.flatnonzero(np.abs(values - self.readings[0]) <= within) if among is None else among
        for ahead, reading in zip(self.places - self.places[0], self.readings, strict=True):
            if not len(found):
                break
            found = found[found + int(ahead) < len(values)]
            found = found[np.abs(values[found + int(ahead)] - reading) <= within]
        return found


def probe_of(values: Array) -> Probe:
    """Return readings from before the middle of a column (n,)."""
    middle = len(values) // 2
    places = np.unique(np.linspace(max(middle - len(values) // 8, 0), middle, PROBES).astype(int))
    return Probe(places, values[places])


class Probed(NamedTuple):
    """Probes of all that a test measured, at the same samples, and by how much a copy of each may differ."""

    probes: dict[str, Probe]
    rounding: dict[str, float]

    @classmethod
    def of(cls, one: Course) -> Probed:
        """Return the probes of a test."""
        return cls({name: probe_of(one.columns[name]) for name in one.measured}, one.rounding)

    def may_be_in(self, other: Course) -> bool:
        """Whether another test holds these readings, all of one sample in one of its own."""
        shared = [name for name in self.probes if name in other.measured]
        found: NDArray[np.intp] | None = None
        for name in shared:  # the first leaves few samples to the others: most pairs of tests end there
            within = max(self.rounding[name], other.rounding[name]) * (1.0 + ROUNDING)
            found = other.near(name, float(self.probes[name].readings[0]), within) if found is None else found
            found = self.probes[name].found_in(other.columns[name], within, found)
        return found is not None and len(found) > 0
