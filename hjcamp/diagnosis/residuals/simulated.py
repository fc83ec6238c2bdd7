"""What a model predicts of windows from the states with which they begin, those of effects that remember among them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.feedthrough import passed_on, passed_to
from hjcamp.diagnosis.data.segments import NUMBER, Layout
from hjcamp.diagnosis.residuals.initial_states import erring_sensors
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.parameter import State

Array = NDArray[np.float64]
ZERO = "zero."
# In usual sizes: by how much a state is moved to see what it changes.
STEP = 1e-3
# So many times the steps of the plant itself: what is stiffer than that costs time for nothing that samples show.
STIFF = 10.0
# With an effect without states of its own each part of a sample may take so many: a strong cubic spring takes 50 where the plant
# takes one, a dead band 20 whose command a lag has smoothed.
BENT = 64.0


class Predicted(NamedTuple):
    """Predicted readings (n, sensors) and states (n, states), each window's states one sample after its last (windows, states),
    SI, and the integrator's steps a sample; ``kept`` (windows, k) are the effects' states with which each window begins, none where
    parts of the windows have models of their own, ``last`` (windows, k) those one sample after its last where a begin is given.
    """

    readings: Array
    states: Array
    ends: Array
    steps: float
    last: Array
    kept: Array | None = None


@dataclass
class Simulated:
    """The windows of a layout as models predict them from ``starts`` (windows, states).

    ``unseen`` (states,): what nothing measures; such states go on from window to window. ``usual_steps`` are what the integrator
    takes a sample; a model that needs far more, where that is not 0, is not simulated to its end. ``forms`` are effects that
    change nothing where a contact slides, in the windows of which ``slides`` (windows,) is true: they are left out there, and the
    time that they take. ``remembered`` (windows,) says what an effect's state is, in usual sizes, where nothing tells with what it
    begins; without it that is as the effect declares.
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

    def readings(self, candidate: Candidate, starts: Array | None = None) -> tuple[Array, Array]:
        """Return the predicted readings (n, sensors) and states (n, states of the plant), SI; may hold NaN where it diverges."""
        found = self._predicted(candidate, starts)
        return found.readings, found.states

    def predicted(self, candidate: Candidate) -> Predicted:
        """Return what a candidate predicts, from the present starts."""
        return self._predicted(candidate)

    def _predicted(self, candidate: Candidate, starts: Array | None = None, kept: Array | None = None) -> Predicted:
        """Return what is predicted; where ``kept`` is given the effects' states begin each window so."""
        layout = self.layout
        inputs = layout.delayed({k.removeprefix(DELAY): v for k, v in candidate.base.items() if k.startswith(DELAY)})
        begin = self._true(candidate, self.starts if starts is None else starts, inputs)
        kept = self._kept(candidate, begin, inputs) if kept is None else kept
        begin = begin if kept is None else np.concatenate([begin, kept], axis=1)
        return self._read_at_once(candidate, self._run(candidate, begin, inputs, layout.width))

    def _kept(self, candidate: Candidate, begin: Array, inputs: Array) -> Array | None:
        """Return the effects' states (windows, k) windows begin with, infinite where they go on; none where all are as declared."""
        states = self._memories(candidate)
        given = {name: self.remembered[name] * item.typical for name, item in states.items() if name in self.remembered}
        found = self._run(candidate, begin, inputs, 1).kept if given else None
        if found is None:
            return None
        fresh, places = self.layout.fresh, self._places(candidate)
        found[~fresh] = np.inf
        for name, own in given.items():
            found[fresh, places[name]] = own[fresh]
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
        if most and any(not self.kernels.effects[name].states for name in candidate.effects if name not in self.forms):
            most = max(most, BENT * layout.fine)
        count = len(begin) * samples
        plain = len(self.sizes)
        # filled where not all windows run at once
        out, states = np.empty((0, len(measured.sensors))), np.empty((0, plain))
        ends, parts = begin[:, :plain].copy(), self._parts(candidate)
        kept: Array | None = None
        last = np.zeros((len(begin), begin.shape[1] - plain))
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
            numbers = [f"{name}.{NUMBER}" for name in simpler.effects if NUMBER in self.kernels.effects[name].parameters]
            for given, group in layout.groups_by(numbers):
                windows = group & part
                if not windows.any():
                    continue
                # nothing is picked out of the whole: most runs are of all windows
                samples_of = slice(None) if windows.all() else np.repeat(windows, samples)
                rows = samples_of if samples == layout.width else of_all[samples_of]
                own, p = windows & begun, model.vector({**values, **given})
                course, fine = layout.course(marks, inputs, rows, begin[own])
                ran = model.run_to_ends(p, course, most=most * len(course.time) / fine)
                read, passed = ran.readings[::fine, measured.columns], ran.states[::fine, :plain]
                if windows.all():
                    out, states = read, passed
                else:
                    out, states = (one if len(one) else np.empty((count, one.shape[1])) for one in (out, states))
                    out[samples_of], states[samples_of] = read, passed
                ends[own] = ran.ends[:, :plain]
                last[own] = ran.ends[:, plain:]
                taken += ran.steps
                if len(parts) == 1 and ran.states.shape[1] > plain:
                    kept = np.zeros((len(begin), ran.states.shape[1] - plain)) if kept is None else kept
                    kept[windows] = ran.states[:: samples * fine, plain:]
        zeros = [candidate.base.get(ZERO + one.field, 0.0) for one in measured.sensors]
        return Predicted(out + np.array(zeros), states, ends, taken / count, last, kept)

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

    def spare(self, candidate: Candidate) -> None:
        """Let every later model take so many more steps than this one at most; a stiffer one counts as one that diverges."""
        self.usual_steps = self._predicted(candidate).steps

    def remembers(self, candidate: Candidate) -> bool:
        """Whether an effect in addition to the forms of contacts has states of its own."""
        return any(self.kernels.effects[name].states for name in candidate.effects if name not in self.forms)

    def _parts(self, candidate: Candidate) -> list[tuple[Candidate, NDArray[np.bool_]]]:
        """Return the model of each part of the windows: without forms where contacts slide, unless another effect has a memory."""
        if self.layout.memory or self.slides is None or self.remembers(candidate) or not self.forms & set(candidate.effects):
            return [(candidate, np.ones(len(self.starts), dtype=bool))]
        return [(candidate.without(self.forms), self.slides), (candidate, ~self.slides)]


def _or_nothing(change: Array) -> Array:
    """Return changes with 0 where there is no number."""
    return np.where(np.isfinite(change), change, 0.0)
