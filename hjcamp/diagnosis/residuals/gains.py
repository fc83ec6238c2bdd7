r"""What states gain in each sample beyond what their rates, at given states, make of them; nothing is simulated.

A store's rate may depend on a speed that nothing measures while its position is measured: then it is the displaced volume that is
known. For a rate f(v), affine in the speed v of a position y, integration by parts gives

.. math:: \int \varphi f(v)\,\mathrm{d}t = \int \varphi f(\hat v)\,\mathrm{d}t + \int \varphi f'\,(\mathrm{d}y - \hat v\,\mathrm{d}t)

whatever the estimate :math:`\hat v`: what the position gains beyond it acts through the slope f' (Shinbrot 1957).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.residuals.initial_states import best_sensors, rate_of
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.run.rates import Along, Course

Array = NDArray[np.float64]
# In usual sizes: by how much a speed is moved to see what it changes. Slopes there that differ by a fifth are none.
MOVED, BENT = 1e-3, 0.1
# Slopes follow the states, which move little in so many samples.
EVERY = 8


class Rated(NamedTuple):
    """The rates along given states, and their slopes (n, states) by each speed of which the position is measured."""

    along: Along
    slopes: tuple[Array, ...]


@dataclass(frozen=True)
class Gains:
    """The gains of the states of a layout's windows; ``moving`` (n, contacts) is on which side each contact is."""

    layout: Layout
    kernels: Kernels
    moving: Array

    def along(self, candidate: Candidate, states: Array, some: slice = slice(None)) -> Along:
        """Return the rates at given states (n, states), those of ``some`` of the samples."""
        layout, count = self.layout, len(self.moving)
        model, values = self.kernels.model(candidate)
        inputs = layout.delayed({k.removeprefix(DELAY): v for k, v in candidate.base.items() if k.startswith(DELAY)})
        if len(inputs) > count:
            inputs = inputs.reshape(count, -1, inputs.shape[1]).mean(axis=1)
        begins, sides, time, inputs = self._begins[some], self._direction[some], layout.time[some], inputs[some]
        parts: list[tuple[slice | NDArray[np.bool_], Along]] = []
        for given, windows in layout.groups:
            rows = slice(None) if windows.all() else np.repeat(windows, layout.width)[some]
            p = model.vector({**values, **given})
            course = Course(layout.measured.period, begins[rows], time[rows], sides[rows], states[rows], inputs[rows])
            parts.append((rows, model.rates.along(p, course, frozenset(candidate.effects))))
        if len(parts) == 1:
            return parts[0][1]
        whole = Along(*(np.empty((len(states), *one.shape[1:])) for one in parts[0][1]))
        for rows, part in parts:
            for into, own in zip(whole, part, strict=True):
                into[rows] = own
        return whole

    def rated(self, candidate: Candidate, states: Array, sloping: bool = True) -> Rated:
        """Return the rates at given states (n, states) with their slopes by speeds, at once: what effects remember stays as it is.

        There are none unless it is ``sloping``.
        """
        plain = candidate.without({name for name in candidate.effects if self.kernels.effects[name].states})
        along = self.along(candidate, states)
        return Rated(along, self._slopes(plain, states) if sloping and self._estimated else ())

    def _slopes(self, plain: Candidate, states: Array) -> tuple[Array, ...]:
        """Return the slopes of rates (n, states) by each estimated speed, 0 where they are not affine in it."""
        some, found = slice(EVERY // 2, None, EVERY), []
        course = states[some]
        now = self.along(plain, course, some).before
        for speed, _ in self._estimated:
            size, ways = MOVED * list(self.layout.measured.plant.states.values())[speed].typical, []
            # unlike steps: a rate that leaps as the speed passes 0 has two slopes there
            for step in (size, -0.5 * size):
                moved = course.copy()
                moved[:, speed] += step
                ways.append((self.along(plain, moved, some).before - now) / step)
            slopes = np.where(np.abs(ways[0] - ways[1]) <= BENT * np.abs(ways[0] + ways[1]), 0.5 * (ways[0] + ways[1]), 0.0)
            found.append(slopes[np.minimum(np.arange(len(states)) // EVERY, len(slopes) - 1)])
        return tuple(found)

    def of(self, state: int, rated: Rated, states: Array, ends: Array | None = None, beyond: Sequence[Array] = ()) -> Array:
        """Return what one of the states (n, states) gains in each sample (n,) beyond what its rate gives, 0 where nothing follows.

        ``ends`` (windows, states) are where predicted states go on to, one sample behind a window; the next one begins elsewhere.
        What positions gain ``beyond`` their estimated speeds acts as well.
        """
        found = self._gained(state, rated.along.before[:, state], rated.along.after[:, state], states, ends)
        for more, slopes in zip(beyond, rated.slopes, strict=False):
            found -= slopes[:, state] * more
        found[self._last] = 0.0
        return found

    def beyond(self, states: Array, ends: Array | None = None) -> list[Array]:
        """Return what measured positions gain in each sample (n,) beyond their estimated speeds; ``ends`` as in `of`."""
        return [
            self._gained(one, states[:, speed], self._next(states[:, speed]), states, ends) for speed, one in self._estimated
        ]

    @staticmethod
    def _next(column: Array) -> Array:
        return np.append(column[1:], 0.0)

    def _gained(self, state: int, before: Array, after: Array, states: Array, ends: Array | None) -> Array:
        """Return what a state gains in each sample (n,) beyond the mean of a rate ``before`` and ``after`` it (n,)."""
        x = states[:, state]
        step = np.append(np.diff(x), 0.0)
        if ends is not None:
            # where the next window does not begin by itself it goes on from there
            apart = np.append(self.layout.begun[1:], True)
            last = np.arange(self.layout.width - 1, len(x), self.layout.width)[apart]
            step[last] = ends[apart, state] - x[last]
        rate = before.copy()
        rate[:-1] += after[:-1]
        return np.asarray(step - 0.5 * self.layout.measured.period * rate)

    @cached_property
    def _estimated(self) -> list[tuple[int, int]]:
        """The places of the speeds that are estimated from measured positions, each with that of its position."""
        plant: Any = self.layout.measured.plant
        names, seen, above = list(plant.states), best_sensors(self.layout.measured), rate_of(plant).items()
        return [(names.index(speed), names.index(one)) for speed, one in above if one in seen and speed not in seen]

    @cached_property
    def _direction(self) -> Array:
        return np.asarray(self.moving @ (3.0 ** np.arange(self.moving.shape[1])))

    @cached_property
    def _begins(self) -> NDArray[np.int64]:
        """1 where effects begin as they declare, else 0 (n,)."""
        found = np.zeros(len(self.moving), dtype=np.int64)
        found[:: self.layout.width] = self.layout.fresh
        return found

    @cached_property
    def _last(self) -> NDArray[np.bool_]:
        """Whether a sample is the last of a run of windows (n,)."""
        begins = np.zeros(len(self.moving), dtype=bool)
        begins[:: self.layout.width] = self.layout.fresh
        return np.append(begins[1:], True)
