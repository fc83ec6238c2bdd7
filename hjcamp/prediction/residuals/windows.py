r"""Residuals over windows: each begins at states of its own, and only what those states cannot explain is kept.

In window w a model gives the readings :math:`y_w(x_w, \theta)` from the state :math:`x_w` with which it begins. With the
sensitivities :math:`S_w = \partial y_w / \partial x_w`, what counts is the residual's part orthogonal to S_w: a wrong start
changes nothing to first order (variable projection; multiple shooting of Bock 1983). It is written as coefficients of
Legendre polynomials in units of the sensor's noise. States that nothing measures go on from the window before
(`hjcamp.prediction.residuals.passage`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.base_values import DELAY
from hjcamp.model.candidate import Candidate
from hjcamp.model.parameter import State
from hjcamp.prediction.measured.at_once import passed_on, passed_to
from hjcamp.prediction.measured.layout import Layout
from hjcamp.prediction.residuals.kernels import Kernels
from hjcamp.prediction.residuals.passage import Passage, Through
from hjcamp.prediction.residuals.starts import erring_sensors, on_sensors

Array = NDArray[np.float64]
STEP = 1e-3
# In its usual sizes, or in its own size where that is more and nothing measures it: how far a start is moved at once.
FARTHEST_MOVED = 3.0
ZERO = "zero."
# So many times the steps of the plant itself: what is stiffer than that costs time for nothing that samples show.
STIFF = 10.0
# Without a state of its own an effect may take so many: a strong cubic spring takes 50 where the plant takes one.
BENT = 64.0


class Place(NamedTuple):
    """Where windows begin: their starts, what these explain, and by how much more effects remember there, by state."""

    starts: Array
    passage: Passage | Through
    remembered: dict[str, Array]


class Predicted(NamedTuple):
    """Predicted readings (n, sensors) and states (n, states), each window's states one sample after its last (windows, states),
    SI, and the integrator's steps a sample; ``kept`` (windows, k) are the effects' states with which each window begins, none where
    parts of the windows have models of their own.
    """

    readings: Array
    states: Array
    ends: Array
    steps: float
    kept: Array | None = None


@dataclass
class Windows:
    """The residuals of models over the windows of a layout; ``starts`` (windows, states) are moved as the tests tell.

    ``unseen`` (states,): what nothing measures; such states go on from window to window. ``usual_steps`` are what the integrator
    takes a sample; a model that needs far more, where that is not 0, is not simulated to its end. ``forms`` are effects that
    change nothing where a contact slides, in the windows of which ``slides`` (windows,) is true: they are left out there, and the
    time that they take. ``remembered`` (windows,) says by how much more than declared, in usual sizes, an effect's state is where
    nothing tells with what it begins.
    """

    layout: Layout
    kernels: Kernels
    starts: Array
    sizes: Array
    lowest: Array
    unseen: NDArray[np.bool_]
    usual_steps: float = 0.0
    forms: frozenset[str] = frozenset()
    slides: NDArray[np.bool_] | None = None
    remembered: dict[str, Array] = field(default_factory=dict)

    @property
    def place(self) -> Place:
        """Where they begin, to come back to."""
        return Place(self.starts, self._passage, self.remembered)

    @place.setter
    def place(self, one: Place) -> None:
        self.starts, self._passage, self.remembered = one

    def readings(self, candidate: Candidate, starts: Array | None = None, friction: float = 1.0) -> tuple[Array, Array]:
        """Return the predicted readings (n, sensors) and states (n, states of the plant), SI; may hold NaN where it diverges.

        ``friction`` is a factor on the static and Coulomb friction of all contacts.
        """
        found = self._predicted(candidate, starts, friction)
        return found.readings, found.states

    def _predicted(
        self, candidate: Candidate, starts: Array | None = None, friction: float = 1.0, kept: Array | None = None
    ) -> Predicted:
        """Return what is predicted; where ``kept`` is given the effects' states begin each window so."""
        layout = self.layout
        inputs = layout.delayed({k.removeprefix(DELAY): v for k, v in candidate.base.items() if k.startswith(DELAY)})
        begin = self._true(candidate, self.starts if starts is None else starts, inputs)
        if friction != 1.0:
            inputs = inputs.copy()
            inputs[:, layout.names.index("friction_scatter")] *= friction
        kept = self._kept(candidate, begin, inputs) if kept is None else kept
        begin = begin if kept is None else np.concatenate([begin, kept], axis=1)
        return self._read_at_once(candidate, self._run(candidate, begin, inputs, layout.width))

    def _kept(self, candidate: Candidate, begin: Array, inputs: Array) -> Array | None:
        """Return the effects' states (windows, k) windows begin with, infinite where they go on; none where all are as declared."""
        states = self._memories(candidate)
        shifts = {name: self.remembered[name] * item.typical for name, item in states.items() if name in self.remembered}
        found = self._run(candidate, begin, inputs, 1).kept if shifts else None
        if found is None:
            return None
        fresh, places = self.layout.fresh, self._places(candidate)
        found[~fresh] = np.inf
        for name, shift in shifts.items():
            found[fresh, places[name]] += shift[fresh]
        return found

    def _memories(self, candidate: Candidate) -> dict[str, State]:
        """Return the states of effects by name, without those of the forms of contacts."""
        effects = [self.kernels.effects[name] for name in candidate.effects if name not in self.forms]
        return {f"{one.name}.{name}": item for one in effects for name, item in one.states.items()}

    def _places(self, candidate: Candidate) -> dict[str, int]:
        """Return the columns of the effects' states, by name."""
        states = list(self.kernels.model(candidate)[0].composition.states)[len(self.sizes) :]
        return {name: k for k, name in enumerate(states)}

    def _read_at_once(self, candidate: Candidate, found: Predicted) -> Predicted:
        """Return what is predicted with what sensors read at once of inputs that run linearly, of which a run holds the mean."""
        layout, plant = self.layout, self.layout.measured.plant
        for place, ahead in layout.ahead.items():
            for k, one in enumerate(layout.measured.sensors):
                if place in passed_to(plant, one.field):
                    found.readings[:, k] += ahead * passed_on(plant, one.field, layout.names[place], candidate.base)
        return found

    def _true(self, candidate: Candidate, starts: Array, inputs: Array) -> Array:
        """Return the true states (windows, states) of starts that are given as sensors without errors would read them.

        What begins where its sensor reads begins elsewhere where that errs: each first reading stays the same. A plant that
        falls by itself would else leave its path before a fit of the sensor's error could follow.
        """
        plant = self.layout.measured.plant
        erring = erring_sensors(plant, {name: self.kernels.effects[name] for name in candidate.effects})
        if not erring:
            return starts
        without = candidate.without(set().union(*erring.values()))
        wrong, right = (self._run(one, starts, inputs, 1).readings for one in (candidate, without))
        places = {
            k: list(plant.states).index(plant.measured[one.field].of)
            for k, one in enumerate(self.layout.measured.sensors)
            if one.field in erring
        }
        moved = starts.copy()
        with np.errstate(all="ignore"):
            for k, place in places.items():
                moved[:, place] -= _or_nothing(wrong[:, k] - right[:, k])
            # Once more along the chord: a gain of 1 + g takes a start over 1 + g, not times 1 - g.
            begun = np.maximum(moved, self.lowest)
            again, moved = self._run(candidate, begun, inputs, 1).readings, begun.copy()
            for k, place in places.items():
                chord = (begun[:, place] - starts[:, place]) / (again[:, k] - wrong[:, k])
                moved[:, place] -= _or_nothing((again[:, k] - right[:, k]) * chord)
        return np.maximum(moved, self.lowest)

    def _run(self, candidate: Candidate, begin: Array, inputs: Array, samples: int) -> Predicted:
        """Return what is predicted of the first ``samples`` of each window, (windows samples, ...).

        They begin at true states (windows, states), those of effects behind them where these are given, under ``inputs`` (n, inputs)
        of the whole windows.
        """
        layout, measured = self.layout, self.layout.measured
        most = STIFF * self.usual_steps
        if most and not self._remembers(candidate):
            most = max(most, BENT)
        count = len(begin) * samples
        plain = len(self.sizes)
        out, states = np.empty((count, len(measured.sensors))), np.empty((count, plain))
        ends, parts = begin[:, :plain].copy(), self._parts(candidate)
        kept: Array | None = None
        of_all = np.arange(len(begin) * layout.width).reshape(-1, layout.width)[:, :samples].ravel()
        taken = 0
        for simpler, part in parts:
            model, values = self.kernels.model(simpler)
            marks, begun = layout.begins.copy(), layout.begun.copy()
            alone = part & ~np.concatenate([[False], part[:-1]])
            # where the states of effects are given nothing is begun for them
            marks[:: layout.width][alone] = 1
            marks[marks == 1] = 1 if begin.shape[1] == plain else 2
            begun |= alone
            for given, group in layout.groups:
                windows = group & part
                if not windows.any():
                    continue
                # nothing is picked out of the whole: most runs are of all windows
                samples_of = slice(None) if windows.all() else np.repeat(windows, samples)
                rows = samples_of if samples == layout.width else of_all[samples_of]
                own, p = windows & begun, model.vector({**values, **given})
                course, fine = layout.course(marks, inputs, rows, begin[own])
                ran = model.run_to_ends(p, course, most=most * len(course.time) / fine)
                out[samples_of], states[samples_of] = ran.readings[::fine, measured.columns], ran.states[::fine, :plain]
                ends[own] = ran.ends[:, :plain]
                taken += ran.steps
                if len(parts) == 1 and ran.states.shape[1] > plain:
                    kept = np.zeros((len(begin), ran.states.shape[1] - plain)) if kept is None else kept
                    kept[windows] = ran.states[:: samples * fine, plain:]
        zeros = [candidate.base.get(ZERO + one.field, 0.0) for one in measured.sensors]
        return Predicted(out + np.array(zeros), states, ends, taken / count, kept)

    def spare(self, candidate: Candidate) -> None:
        """Let every later model take so many more steps than this one at most; a stiffer one counts as one that diverges."""
        self.usual_steps = self._predicted(candidate).steps

    def _remembers(self, candidate: Candidate) -> bool:
        """Whether an effect beside the forms of contacts has states of its own."""
        return any(self.kernels.effects[name].states for name in candidate.effects if name not in self.forms)

    def _parts(self, candidate: Candidate) -> list[tuple[Candidate, NDArray[np.bool_]]]:
        """Return the model of each part of the windows: without forms where contacts slide, unless another effect has a memory."""
        if self.layout.memory or self.slides is None or self._remembers(candidate) or not self.forms & set(candidate.effects):
            return [(candidate, np.ones(len(self.starts), dtype=bool))]
        return [(candidate.without(self.forms), self.slides), (candidate, ~self.slides)]

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
            left, passage, starts = self._left(found), self._passage_of(candidate, found), self.starts / self.sizes
            moved = passage.begun(left, starts, found.ends / self.sizes)[0] - starts
            most = FARTHEST_MOVED * np.where(self.unseen, np.maximum(1.0, np.abs(starts)), 1.0)
            tried = np.maximum(self.starts + np.clip(moved, -most, most) * self.sizes, self.lowest)
            before = self._of_starts(passage.less(left))
            kept, self.starts = self.starts, tried
            known, self.remembered = self.remembered, self._recalled(candidate, passage.recalled(left))
            seen = self._predicted(candidate)
            # what readings do not tell of a start changes them by less than their noise
            better = self._of_starts(passage.less(self._left(seen))) < before + passage.open
            self.starts = np.where(better[:, None], tried, kept)
            self.remembered = {name: np.where(better, one, known.get(name, 0.0)) for name, one in self.remembered.items()}
            if better.any():
                found = seen if better.all() else self._predicted(candidate)
        self._passage = self._passage_of(candidate, found)
        return self._unexplained(found)

    def _recalled(self, candidate: Candidate, shift: Array) -> dict[str, Array]:
        """Return by how much more effects remember, moved by shifts (windows, k)."""
        moved = np.clip(shift, -FARTHEST_MOVED, FARTHEST_MOVED).T
        return self.remembered | {
            name: self.remembered.get(name, 0.0) + one for name, one in zip(self._memories(candidate), moved, strict=False)
        }

    def _of_starts(self, left: Array) -> Array:
        """Return the squares (windows,) of errors (windows, coefficients), summed over all windows that share a start."""
        squares, shared = np.sum(left**2, axis=1), np.cumsum(self.layout.begun) - 1
        return np.asarray(np.bincount(shared, squares)[shared])

    def begun_for(self, candidate: Candidate, place: Place) -> Windows:
        """Return these windows where they meet a model's readings best, moved there from a ``place``."""
        own = replace(self)
        own.place = place
        own.move_starts(candidate)
        return own

    def memory(self, candidate: Candidate) -> int:
        """Return the samples in which the readings forget a start where tests are simulated through: the slowest state.

        Forgotten is what has fallen to 1/e of the most that it made of the readings, for good; the median of the tests.
        """
        layout, base, found = self.layout, self.readings(candidate)[0], 0
        of_test = np.repeat(layout.of_test, layout.width)
        for k, size in enumerate(self.sizes):
            moved = self.starts.copy()
            moved[:, k] += STEP * size
            with np.errstate(invalid="ignore", over="ignore"):
                change = np.abs((self.readings(candidate, moved)[0] - base) / layout.measured.noise).max(axis=1)
            if not np.isfinite(change).all():
                return len(base)
            left = [change[of_test == test] for test in np.unique(of_test)]
            found = max(found, int(np.median([np.flatnonzero(one * np.e >= one.max())[-1] + 1 for one in left])))
        return found

    def renew(self, candidate: Candidate) -> None:
        """Renew what a change of each window's start explains."""
        self._passage = self._passage_of(candidate, self._predicted(candidate))

    def _passage_of(self, candidate: Candidate, base: Predicted) -> Passage | Through:
        """Return what a change of each start, by its usual size, changes of the readings and the ends that are predicted.

        It is the change of one start alone: the states of effects, which go on from window to window, begin as they did without it.
        """
        readings, ends = [], []
        for k, size in enumerate(self.sizes):
            moved = self.starts.copy()
            moved[:, k] += STEP * size
            changed = self._predicted(candidate, moved, kept=base.kept)
            with np.errstate(over="ignore", invalid="ignore"):
                change = self.layout.coefficients((changed.readings - base.readings) / STEP)
                ends.append((changed.ends - base.ends) / (STEP * self.sizes))
            readings.append(change.reshape(len(self.starts), -1))
        states = self._memories(candidate)
        first = self._of_states(candidate, base, states)
        if self.layout.memory:
            return Through.of(np.stack(readings, axis=2), self.layout.of_test, first)
        own = None
        if first is not None:
            effects = on_sensors(self.layout.measured.plant, [self.kernels.effects[name] for name in candidate.effects])
            of_sensors = [name.rpartition(".")[0] in {one.name for one in effects} for name in states]
            own = np.where(self.layout.fresh[:, None, None], 0.0, first[:, :, of_sensors]) if any(of_sensors) else None
            first[~self.layout.fresh] = 0.0
        return Passage.of(np.stack(readings, axis=2), np.stack(ends, axis=2), self.unseen, self.layout.goes_on, own, first)

    def _of_states(self, candidate: Candidate, base: Predicted, states: Mapping[str, State]) -> Array | None:
        """Return what states of effects change of the readings (windows, coefficients, k), in usual sizes; none where there is none."""
        if base.kept is None or not states:
            return None
        places, found = self._places(candidate), []
        for name, item in states.items():
            moved = base.kept.copy()
            moved[:, places[name]] += STEP * item.typical
            changed = self._predicted(candidate, kept=moved)
            with np.errstate(over="ignore", invalid="ignore"):
                change = self.layout.coefficients((changed.readings - base.readings) / STEP)
            found.append(change.reshape(len(self.starts), -1))
        return np.stack(found, axis=2)

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

    def growth(self, candidate: Candidate) -> float:
        """Return how often as large a small change of the start is at a window's end as in its first half: most of the states,
        the median window.
        """
        layout, base, found = self.layout, self.readings(candidate)[0], 0.0
        for k, size in enumerate(self.sizes):
            moved = self.starts.copy()
            moved[:, k] += STEP * size
            change = (self.readings(candidate, moved)[0] - base) / layout.measured.noise
            shaped = np.abs(change.reshape(len(moved), layout.width, -1)).max(axis=2)
            half = shaped[:, : layout.width // 2].max(axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = shaped[:, -1] / half
            seen = ratio[np.isfinite(ratio)]
            found = max(found, float(np.median(seen))) if len(seen) else found
        return found

    def features(self, candidate: Candidate, friction: float = 1.0) -> Array:
        """Return what no start explains (windows, features), in units of the sensors' noise; NaN where the model diverges.

        What nothing measures begins where the window before ended.
        """
        return self._unexplained(self._predicted(candidate, friction=friction))

    def _unexplained(self, found: Predicted) -> Array:
        """Return what no start explains of the errors of a prediction."""
        return self._passage.unexplained(self._left(found), self.starts / self.sizes, found.ends / self.sizes)


def _or_nothing(change: Array) -> Array:
    """Return changes with 0 where there is no number."""
    return np.where(np.isfinite(change), change, 0.0)
