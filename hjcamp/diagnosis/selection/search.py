"""What may be missing of a model, and how two fitted models are compared."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.candidates.equivalence import is_of_its_own, law_of, memory_end, times_remembered
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown, courses_of_each, values_of
from hjcamp.diagnosis.estimation.gauss_newton import SETTLED
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.residuals.windows import Place
from hjcamp.diagnosis.selection.fits import Fits
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import advantages, critical, discrimination, ratio_t

Array = NDArray[np.float64]


@dataclass
class Search(Fits):
    """The candidates of an analysis.

    ``unnamed`` are effects of the library that a base may have (the forms of contacts), but that are not looked for; ``wanted`` those
    that are fitted whatever they promise.
    """

    unnamed: frozenset[str] = frozenset()
    wanted: frozenset[str] = frozenset()

    def at(self, place: Place) -> Search:
        """Return this search with windows of its own, which begin at a ``place``."""
        own = copy.copy(self)
        own.windows = copy.copy(self.windows)
        own.windows.place = place
        return own

    def may_be_added(self, name: str, present: Iterable[str]) -> bool:
        """Whether an effect is looked for and not there yet, and no other one that says the same of the same driver.

        Two laws of one driver in one place are one law of another form: the second would only mend the first. What acts behind all
        others in a slot is looked for where one of them bends it.
        """
        law = law_of(self.library[name]) if name in self.library else None
        named = [self.library[one] for one in present if one in self.library]
        return (
            name not in (*present, *self.unnamed)
            and not any(law and law == law_of(one) for one in named)
            and (name not in self.library or is_of_its_own(self.library[name], named))
        )

    def values(self, before: Scored | None = None) -> dict[str, Unknown]:
        """Return the laws of the base's parameters that are no constants, and `drifts`; no model has them before they are admitted.

        Of a parameter that stands at its bound in a model there is none: its law would go on where that may not.
        """
        plant = self.windows.layout.measured.plant
        names = [one.name for one in self.base_free if before is None or not one.bounded(before.fitted.candidate)]
        return values_of(plant, names, self.ranges) | self.drifts()

    def drifts(self) -> dict[str, Unknown]:
        """Return the laws over time with a course of its own in each condition, by name.

        A course has half as many pieces as its condition has blocks: of fewer than two no block tells of another one.
        """
        layout = self.windows.layout
        conditions = len(layout.measured.conditions)
        pieces = len(np.unique(self.blocks)) // conditions // 2
        if conditions < 2 or pieces < 2:
            return {}
        return courses_of_each(layout.measured.plant, conditions, pieces + 1, float(layout.time.max()), self.ranges)

    def admit(self, laws: Mapping[str, Unknown]) -> None:
        """Let further unknowns be part of models."""
        self.windows.kernels.add({name: one.effect for name, one in laws.items() if name not in self.unknowns})
        self.unknowns = {**self.unknowns, **laws}

    def of_no_memory(self, model: Scored, before: Scored) -> bool:
        """Whether the time for which an effect remembers reaches an end of what it may be, or of what readings resolve.

        That it remembers is not shown then.
        """
        effects = (name for name in model.beyond(before) if name in self.library)
        times = {(name, key): ends for name in effects for key, ends in times_remembered(self.library[name]).items()}
        rows = intervals(model.fitted, self.blocks) if times else []
        remembered = ((one, times[one.effect, one.name]) for one in rows if (one.effect, one.name) in times)
        return any(memory_end((one.low, one.high), bounds, self.shortest_memory) for one, bounds in remembered)

    @property
    def shortest_memory(self) -> float:
        """The time that the smooth part of a window resolves, s: what is forgotten sooner follows the moment for all that it shows."""
        layout = self.windows.layout
        return float(layout.width / layout.basis.shape[1] * layout.measured.period)

    def predicted(self, model: Scored) -> Array:
        """Return what a model predicts of all readings (n, sensors), from its own starts."""
        found = self.at(model.place).windows.readings(model.fitted.candidate)[0]
        return np.where(np.isfinite(found), found, self.windows.layout.readings)

    def beats(self, model: Scored, other: Scored, level: float = LEVEL) -> bool:
        """Whether a model is better on blocks that it does not know, at a level, and by more than a fit leaves to be gained.

        Two laws that do the same differ by where their fits ended, in each block by next to nothing.
        """
        if not math.isfinite(model.left_out) or not math.isfinite(other.left_out):
            return math.isfinite(model.left_out)
        t, blocks = self.t(model, other)
        return t > critical(blocks, level) and float(np.sum(advantages(model.features, other.features, self.blocks))) > SETTLED

    def t(self, model: Scored, other: Scored) -> tuple[float, float]:
        """Return Student's t of a model's advantage over another, and the number of blocks that it stands on."""
        found = advantages(model.features, other.features, self.blocks)
        return ratio_t(found, discrimination(model.fitted.features, other.fitted.features, self.blocks))
