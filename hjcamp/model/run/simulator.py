"""A composed model ready to run: names to vectors, propagators, a replay or a free run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import unknown
from hjcamp.model.compile import regimes, shared
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import LEVELS, copied, kernel_source, load_model
from hjcamp.model.compile.source_text import GATES
from hjcamp.model.compile.structure import Point, nonlinear_rates, points_of
from hjcamp.model.declare.course import Course, Followed, Given
from hjcamp.model.declare.law import Law
from hjcamp.model.files.time_limit import time_limit
from hjcamp.model.language import term_checks
from hjcamp.model.language.amount_formula import MATHEMATICS
from hjcamp.model.language.term_checks import check_compiles, check_law_compiles, limited, users_files
from hjcamp.model.run import driving
from hjcamp.model.run.rates import Rates

Array = NDArray[np.float64]
PERIOD = 1e-3
# What a step corrects where one went before may be so many times what it may be elsewhere (`compile.integrator`). Fits take no
# advantage of it: they compare runs that hardly differ.
BEFORE = 3.0


class Propagators(NamedTuple):
    """The exact steps of a model's linear parts for one sampling period: see `hjcamp.model.compile.shared`.

    A kernel adds to them when it first comes into a regime: no two threads may share them.
    """

    plan: NDArray[np.int64]
    space: Array
    steps: Array


class Ran(NamedTuple):
    """Tests under given inputs: readings (n, channels), states (n, states), SI, and the steps that they took.

    ``ends`` (tests and windows, plant states) are the states one sample after the last one of each.
    """

    readings: Array
    states: Array
    ends: Array
    steps: int


@dataclass(frozen=True)
class Simulator:
    """A composition compiled into one kernel.

    ``free`` it runs under its given inputs alone, else it is driven along what was measured. A loop of its own comes with
    ``laws``: see `hjcamp.model.run.closed_loop`.
    """

    composition: Composition
    free: bool = False

    @cached_property
    def source(self) -> str:
        """The text of the kernel, for which its equations are called as Python."""
        return self._looked_at(self._text)

    @cached_property
    def rates(self) -> Rates:
        """The rates of the composition, compiled by themselves."""
        return Rates(self.composition)

    def _looked_at(self, write: Callable[[], str]) -> str:
        if self.users_files:
            with time_limit(term_checks.LOOKING_S, self.users_files):
                return write()
        return write()

    def _text(self) -> str:
        composition = self.composition
        if self.free:
            return kernel_source(composition, "\n\n" + copied(driving, ("run_free",)))
        inputs = composition.inputs
        states, driven = list(composition.states), list(composition.cut.driven)
        # numba takes no empty tuple by an index
        lines = [
            f"PLANT_STATES = {len(composition.plant.states)}",
            f"GIVEN = {len(inputs) - len(driven)}",
            f"DRIVEN = {len(driven)}",
            f"OBSERVED = {len(composition.observed)}",
            f"DRIVEN_STATES = {tuple(states.index(name) for name in driven) or (-1,)}",
            f"OBSERVED_STATES = {tuple(states.index(name) for name in composition.observed) or (-1,)}",
            f"DRIVEN_INPUTS = {tuple(inputs.index('slope_' + name) for name in driven) or (-1,)}",
        ]
        return kernel_source(composition, "\n".join(lines) + "\n\n\n" + copied(driving, ("follow",)))

    @cached_property
    def checked_source(self) -> str:
        """The text of the kernel; raises ``UsageError`` for a user's effect or controller that cannot be compiled."""
        for effect in self.composition.effects:
            check_compiles(effect, tuple(MATHEMATICS))  # type: ignore[arg-type]
        for law in self.laws:
            check_law_compiles(law, tuple(MATHEMATICS))  # type: ignore[arg-type]
        return self.source

    @cached_property
    def kernel(self) -> ModuleType:
        """The imported kernel of the text that was checked."""
        return load_model(self.checked_source)

    @cached_property
    def users_files(self) -> str:
        """The effects and the controller that are files of the user's, in words; empty where all are ours."""
        return users_files([*self.composition.effects, *self.laws])

    @property
    def laws(self) -> tuple[type[Law], ...]:
        """The laws in its loop that a user may have written; none where nothing controls."""
        return ()

    @property
    def states(self) -> list[str]:
        """Names of the states in order."""
        return list(self.composition.states)

    def vector(self, values: Mapping[str, float]) -> Array:
        """Return the parameter vector for ``values`` by full name, completed by the defaults."""
        known = self.composition.parameters
        for name in values:
            if name not in known:
                raise unknown("parameter", name, known, f"the model of {self.composition.plant.name}")
        found = self._defaults | {name: float(value) for name, value in values.items()}
        if self.composition.gated:
            opened = [found[f"gate.{effect.name}"] != 0.0 for effect in self.composition.effects]
            found[GATES] = float(sum(1 << place for place, one in enumerate(opened) if one))
        return np.array(list(found.values()))

    @cached_property
    def _defaults(self) -> dict[str, float]:
        """The parameters by full name, in order, as they are declared."""
        return {name: float(parameter.default) for name, parameter in self.composition.parameters.items()}

    def inputs(self) -> Array:
        """Return the input vector at its defaults."""
        known = self.composition.plant.inputs
        return np.array([known[name].default if name in known else 0.0 for name in self.composition.inputs])

    @limited
    def begin(self, start: Mapping[str, float], p: Array) -> Array:
        """Return the state vector for the given plant states; own states of effects start as they declare."""
        z = np.zeros(len(self.states))
        for name, value in start.items():
            z[self.states.index(name)] = value
        if any("." in name for name in self.states):
            self.kernel.begin(0.0, 0.0, z, self.inputs(), p)
        return z

    def observed(self, course: Course) -> Array:
        """Return the state vector with which a course begins, as measured; what is not observed is 0."""
        z = np.zeros(len(self.states))
        for name, value in zip(self.composition.observed, course.observed[0], strict=True):
            z[self.states.index(name)] = value
        return z

    def propagators(self, z: Array, p: Array) -> Propagators:
        """Return an empty set of propagators; each regime is linearised about ``z`` when a test first comes into it."""
        present, curved = self._present(int(p[-1]) if self.composition.gated else 0)
        w, u = shared.width(len(present)), self.inputs()
        plan = np.zeros(shared.STATES + 3 * len(present) + len(curved), dtype=np.int64)
        plan[shared.PRESENT], plan[shared.CURVED], plan[shared.WIDTH] = len(present), len(curved), w
        plan[shared.STATES : -2 * len(present)] = *present, *curved
        space = np.zeros((shared.SPACE, max(w * w, len(z), len(u))))
        space[regimes.ABOUT, : len(z)] = z
        space[regimes.INPUTS, : len(u)] = u
        return Propagators(plan, space, np.empty((shared.REGIMES * (LEVELS + 1), 3 * w * w)))

    @cached_property
    def _found(self) -> dict[int, tuple[list[int], list[int]]]:
        return {}

    @cached_property
    def _points(self) -> list[Point]:
        return points_of(self.composition)

    def _present(self, gates: int) -> tuple[list[int], list[int]]:
        """Return the positions of the states behind open gates, and which of them have curved rates: positions in the former."""
        if gates not in self._found:
            composition = self.composition
            if not composition.gated:
                present = list(range(len(self.states)))
                curved = self.kernel.CURVED_RATES
            else:
                absent = {effect.name for k, effect in enumerate(composition.effects) if not gates >> k & 1}
                present = [i for i, name in enumerate(self.states) if name.rpartition(".")[0] not in absent]
                curved = nonlinear_rates(composition, self.kernel.rates, gates, self._points)
            self._found[gates] = present, [k for k, i in enumerate(present) if curved[i]]
        return self._found[gates]

    @limited
    def follow(self, p: Array, course: Course, propagators: Propagators | None = None, tolerance: float = 1.0) -> Followed:
        """Drive the plant along ``course`` with the measured values of the cut's driven states.

        ``tolerance`` is the accepted correction of one step, in units of the states' resolution.
        """
        channels = len(self.composition.measured)
        z = self.observed(course)
        propagators = propagators or self.propagators(z, p)
        readings, ideal = np.empty((len(course.time), channels)), np.empty(course.observed.shape)
        forces = np.empty((len(course.time), len(self.composition.plant.balance)))
        work = self.scratch()
        work[2, 3], work[2, 5] = tolerance, tolerance
        self.kernel.follow(
            z, self.inputs(), p, *propagators, course.period, course.restart, course.time, course.driven,
            course.observed, course.velocity, course.given, readings, ideal, forces, work,
        )  # fmt: skip
        return Followed(readings, ideal, forces, work[2, 1])

    def run_free(self, p: Array, given: Given, tolerance: float = 1.0, most: float = 0.0) -> tuple[Array, Array]:
        """Return the readings (n, channels) and the states (n, states) of tests under given inputs, SI.

        After ``most`` steps of the integrator, where any are given, they are NaN.
        """
        found = self.run_to_ends(p, given, tolerance, most)
        return found.readings, found.states

    @limited
    def run_to_ends(self, p: Array, given: Given, tolerance: float = 1.0, most: float = 0.0) -> Ran:
        """Return what `run_free` does, the states with which each test or window ends, and the number of steps that it took."""
        composition = self.composition
        starts = np.ascontiguousarray(given.starts)
        readings = np.empty((len(given.time), len(composition.measured)))
        states, ends = np.empty((len(given.time), len(self.states))), np.empty(starts.shape)
        z, work = np.zeros(len(self.states)), self.scratch()
        z[: starts.shape[1]] = starts[0]
        work[2, 3], work[2, 5], work[3, 0] = tolerance, tolerance, most
        self.kernel.run_free(
            z, self.inputs(), p, *self.propagators(z, p), given.period, given.begins, given.time, given.inputs, starts,
            readings, states, ends, work,
        )  # fmt: skip
        return Ran(readings, states, ends, int(work[2, 1]))

    def scratch(self) -> Array:
        """Return fresh working memory for the kernel's loops; the tolerance of a step is set to one resolution."""
        columns = regimes.KINDS + len(self.composition.contacts)
        work = np.zeros((4, max(3 * len(self.states), len(self.composition.measured), columns)))
        work[2, 3], work[2, 5], work[2, 8] = BEFORE, 1.0, -1.0
        return work

    def signals(self, names: Sequence[str]) -> list[int]:
        """Return the positions of the named signals in the output of the kernel's ``signals``."""
        order = list(self.composition.vocabulary.signals)
        return [order.index(name) for name in names]
