r"""Residuals over windows: each begins at states of its own, and only what those states cannot explain is kept.

In window w a model gives the readings :math:`y_w(x_w, \theta)` from the state :math:`x_w` with which it begins. With the
sensitivities :math:`S_w = \partial y_w / \partial x_w`, what counts is the residual's part orthogonal to S_w: a wrong start
changes nothing to first order (variable projection; multiple shooting of Bock 1983). It is written as coefficients of
Legendre polynomials in units of the sensor's noise. States that nothing measures go on from the window before
(`hjcamp.diagnosis.residuals.continuity`).
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import WINDOWS
from hjcamp.diagnosis.residuals.balances import Balances, Usual
from hjcamp.diagnosis.residuals.continuity import Memory, Passage, Through
from hjcamp.diagnosis.residuals.initial_states import on_sensors
from hjcamp.diagnosis.residuals.simulated import STEP, Predicted, Simulated
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
# In its usual sizes, or in its own size where that is more and nothing measures it: how far a start is moved at once.
FARTHEST_MOVED = 3.0
# Starts of a fit are judged by one in so many runs of windows.
ONE_IN = 4


class Place(NamedTuple):
    """Where windows begin: their starts, what these explain, what effects remember there, by state, and what balances usually are."""

    starts: Array
    passage: Passage | Through
    remembered: dict[str, Array]
    usual: Usual | None = None


@dataclass
class Windows(Simulated):
    """The residuals of models over the windows of a layout, whose starts are moved as the tests tell, with ``balances`` if any."""

    balances: Balances | None = None
    usual: Usual | None = None

    @property
    def place(self) -> Place:
        """Where they begin, to come back to."""
        return Place(self.starts, self._passage, self.remembered, self.usual)

    @place.setter
    def place(self, one: Place) -> None:
        self.starts, self._passage, self.remembered, self.usual = one

    def errors(self, candidate: Candidate) -> Array:
        """Return measured less predicted readings (n, sensors), SI, from the present starts; held where sensors read their ends."""
        return self._error(self._predicted(candidate))

    def _error(self, found: Predicted) -> Array:
        return self.layout.readings - self.layout.held(found.readings)

    def _left(self, found: Predicted) -> Array:
        """Return the coefficients (windows, coefficients) of the errors of a prediction."""
        return self.layout.coefficients(self._error(found)).reshape(len(self.starts), -1)

    def move_starts(self, candidate: Candidate, rounds: int = 2) -> Array:
        """Move each window's start to where its readings are met best, renew the sensitivities, and return the features there."""
        found = self._predicted(candidate)
        for _ in range(rounds):
            found = self._moved(candidate, found, self._passage_of(candidate, found))
        self._passage = self._passage_of(candidate, found)
        if self._balanced:
            self.usual = self._balanced.usual_of(candidate.without(self.forms), found)
        return self._unexplained(candidate, found)

    @property
    def _balanced(self) -> Balances | None:
        """The balances of these windows; there are none of other ones."""
        return self.balances if self.balances is not None and self.balances.layout is self.layout else None

    def along(self, candidate: Candidate) -> Array:
        """Return the features of a model; of one that remembers, with starts that are moved along with it, and kept as they are here.

        What it remembers goes on from window to window, and so does what starts make of it, which no passage of one window has.
        """
        if not self.remembers(candidate):
            return self.features(candidate)
        own = copy.copy(self)
        return own._unexplained(candidate, own._moved(candidate, own._predicted(candidate), own._passage))

    def _moved(self, candidate: Candidate, found: Predicted, passage: Passage | Through) -> Predicted:
        """Move each window's start from a prediction to where a passage meets its readings best, and return what is predicted there."""
        left, starts = self._left(found), self.starts / self.sizes
        moved = passage.begun(left, starts, found.ends / self.sizes)[0] - starts
        most = FARTHEST_MOVED * np.where(self.unseen, np.maximum(1.0, np.abs(starts)), 1.0)
        tried = np.maximum(self.starts + np.clip(moved, -most, most) * self.sizes, self.lowest)
        before = self._of_starts(passage.less(left))
        kept, self.starts = self.starts, tried
        known = self._known(candidate, found)
        self.remembered = self.remembered | self._recalled(known, passage.recalled(left))
        seen = self._predicted(candidate)
        # what readings do not tell of a start changes them by less than their noise
        better = self._of_starts(passage.less(self._left(seen))) < before + passage.open
        self.starts = np.where(better[:, None], tried, kept)
        self.remembered = self.remembered | {name: np.where(better, self.remembered[name], one) for name, one in known.items()}
        if better.all():
            return seen
        return self._predicted(candidate) if better.any() else found

    def _known(self, candidate: Candidate, found: Predicted) -> dict[str, Array]:
        """Return what effects remember where windows begin (windows,), in usual sizes, by a prediction; none where it tells none."""
        if found.kept is None:
            return {}
        states, places = self._memories(candidate), self._places(candidate)
        seen = {name: found.kept[:, places[name]] / item.typical for name, item in states.items()}
        return {name: np.where(np.isfinite(one), one, self.remembered.get(name, 0.0)) for name, one in seen.items()}

    def _recalled(self, known: dict[str, Array], shift: Array) -> dict[str, Array]:
        """Return what effects remember (windows,), moved by shifts (windows, k), which may be of fewer states."""
        moved = np.clip(shift, -FARTHEST_MOVED, FARTHEST_MOVED).T
        return known | {name: one + more for (name, one), more in zip(known.items(), moved, strict=False)}

    def _of_starts(self, left: Array) -> Array:
        """Return the squares (windows,) of errors (windows, coefficients), summed over all windows that share a start."""
        squares, shared = np.sum(left**2, axis=1), np.cumsum(self.layout.begun) - 1
        return np.asarray(np.bincount(shared, squares)[shared])

    def some(self) -> Windows:
        """Return one in a few runs of windows, without balances: enough of them to judge starts by, all where there are no more."""
        every = 1 if self.layout.memory else min(len(self.layout.of_test) // WINDOWS, ONE_IN)
        if every <= 1:
            return replace(self, balances=None)
        layout = replace(self.layout, every=every)
        rows = layout.looked_at[self.layout.looked_at]
        remembered = {name: one[rows] for name, one in self.remembered.items()}
        slides = None if self.slides is None else self.slides[rows]
        return replace(self, layout=layout, starts=self.starts[rows], slides=slides, remembered=remembered, balances=None)

    def begun_for(self, candidate: Candidate, place: Place) -> Windows:
        """Return these windows where they meet a model's readings best, moved there from a ``place``."""
        own = replace(self)
        own.place = place
        own.move_starts(candidate)
        return own

    def renew(self, candidate: Candidate) -> None:
        """Renew what a change of each window's start explains."""
        self._passage = self._passage_of(candidate, self._predicted(candidate))

    def _passage_of(self, candidate: Candidate, base: Predicted) -> Passage | Through:
        """Return what a change of each start, by its usual size, changes of the readings and the ends that are predicted.

        It is the change of one start alone: the states of effects, which go on from window to window, begin as they did without it.
        """
        moved = []
        for k, size in enumerate(self.sizes):
            starts = self.starts.copy()
            starts[:, k] += STEP * size
            moved.append(self._predicted(candidate, starts, kept=base.kept))
        readings = np.stack([self._change(one, base) for one in moved], axis=2)
        memory = self._memory_of(candidate, base, moved)
        if self.layout.memory:
            return Through.of(readings, self.layout.of_test, memory)
        with np.errstate(over="ignore", invalid="ignore"):
            ends = np.stack([(one.ends - base.ends) / (STEP * self.sizes) for one in moved], axis=2)
        return Passage.of(readings, ends, self.unseen, self.layout.goes_on, memory)

    def _change(self, moved: Predicted, base: Predicted) -> Array:
        """Return what a state that is moved by a step changes of the readings (windows, coefficients), for its usual size."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.layout.coefficients((moved.readings - base.readings) / STEP).reshape(len(self.starts), -1)

    def _memory_of(self, candidate: Candidate, base: Predicted, moved: Sequence[Predicted]) -> Memory | None:
        """Return what effects remember, ``moved`` being what starts change; none where they remember nothing."""
        states = self._memories(candidate)
        if base.kept is None or not states:
            return None
        own, sizes = [self._places(candidate)[name] for name in states], np.array([item.typical for item in states.values()])
        changed = []
        for place, size in zip(own, sizes, strict=True):
            kept = base.kept.copy()
            kept[:, place] += STEP * size
            changed.append(self._predicted(candidate, kept=kept))
        last = self._predicted(candidate, kept=base.kept).last
        with np.errstate(over="ignore", invalid="ignore"):
            by_starts, by_memory = (
                np.stack([(one.last - last)[:, own] / (STEP * sizes) for one in group], axis=2) for group in (moved, changed)
            )
        effects = on_sensors(self.layout.measured.plant, [self.kernels.effects[name] for name in candidate.effects])
        of_sensors = np.array([name.rpartition(".")[0] in {one.name for one in effects} for name in states])
        readings = np.stack([self._change(one, base) for one in changed], axis=2)
        return Memory(readings, by_starts, by_memory, of_sensors, self.layout.fresh)

    def passed(self, candidate: Candidate) -> tuple[Array, Array]:
        """Return each window's end (windows, states) and what unseen starts change of it (windows, states, states), in sizes."""
        before = self._predicted(candidate)
        base = before.ends
        found = np.zeros((*base.shape, len(self.sizes)))
        for k in np.flatnonzero(self.unseen):
            moved = self.starts.copy()
            moved[:, k] += STEP * self.sizes[k]
            found[:, :, k] = (self._predicted(candidate, moved, kept=before.kept).ends - base) / (STEP * self.sizes)
        return base / self.sizes, np.where(np.isfinite(found), found, 0.0)

    def features(self, candidate: Candidate) -> Array:
        """Return what no start explains (windows, features), in units of the sensors' noise; NaN where the model diverges.

        What nothing measures begins where the window before ended.
        """
        return self._unexplained(candidate, self._predicted(candidate))

    def _unexplained(self, candidate: Candidate, found: Predicted) -> Array:
        """Return what no start explains of the errors of a prediction, and behind it the balances."""
        own = self._passage.unexplained(self._left(found), self.starts / self.sizes, found.ends / self.sizes)
        if self._balanced is None:
            return own
        return np.concatenate([own, self._balanced.features(candidate, found, self.usual)], axis=1)
