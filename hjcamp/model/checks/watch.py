"""A limit as data: which columns of a log it looks at, in which phases, and how far a test stays from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.language.field_unit import field_of, unit_of_field

if TYPE_CHECKING:
    from hjcamp.model.declare.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Term:
    """``factor`` times a column, taken ``late`` samples earlier."""

    column: str
    factor: float = 1.0
    late: int = 0


@dataclass(frozen=True)
class Watch:
    r"""A quantity with limits, from the columns of a log.

    .. math:: w_k = \sum_i f_i c_{i, k - l_i}, \quad \mathrm{margin} = \min(\mathrm{high} - w, w - \mathrm{low})

    ``low`` and ``high`` are in ``unit``, None where there is none. ``phases`` (first, last) are those in which it counts.
    """

    name: str
    unit: str
    terms: tuple[Term, ...]
    low: float | None = None
    high: float | None = None
    phases: tuple[float, float] = (-np.inf, np.inf)

    @property
    def reach(self) -> int:
        """How many samples it looks back."""
        return max(term.late for term in self.terms)

    def values(self, columns: Mapping[str, Array]) -> Array:
        """Return the quantity (n - reach,) for columns (n,): NaN out of its phases; empty where a column is absent."""
        if any(term.column not in columns for term in self.terms):
            return np.empty(0)
        length = max(len(columns[self.terms[0].column]) - self.reach, 0)
        total = np.zeros(length)
        for term in self.terms:
            start = self.reach - term.late
            total = total + term.factor * columns[term.column][start : start + length]
        if "phase" in columns:
            phase = columns["phase"][self.reach : self.reach + length]
            total = np.where((phase >= self.phases[0]) & (phase <= self.phases[1]), total, np.nan)
        return total

    def margin(self, values: Array) -> float | None:
        """Return the smallest distance to a limit, negative beyond it; None where there is no value or no limit."""
        found = values[np.isfinite(values)]
        if not found.size:
            return None
        ends = [self.high - found.max()] if self.high is not None else []
        ends += [found.min() - self.low] if self.low is not None else []
        return float(min(ends)) if ends else None


def plausible_watches(plant: type[Plant]) -> list[Watch]:
    """Return what a sound log of a plant stays within, as its channels and inputs declare it (SI there, the field's unit here)."""
    where = f"plant {plant.name}"
    known = [(channel.field, channel.plausible) for channel in plant.channels]
    known += [(one.name, one.plausible) for one in plant.measured.values()]
    inputs = [one for one in plant.given_inputs().values() if np.isfinite(one.plausible).any()]
    known += [(one.field or field_of(one.name, one.unit, where), one.plausible) for one in inputs]
    found = []
    for field, ends in known:
        unit = unit_of_field(field, where)
        low, high = (float(end * unit.scale) if np.isfinite(end) else None for end in ends)
        if low is not None or high is not None:
            found.append(Watch(field, unit.shown, (Term(field),), low, high))
    return found
