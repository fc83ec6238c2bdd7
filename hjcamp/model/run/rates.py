"""The rates of a composed model along given states: what its equations say of measured ones, without simulating anything."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel_cache import load_kernel
from hjcamp.model.compile.rates_loop import open_states, rates_kernel_source
from hjcamp.model.language.term_checks import limited, users_files

Array = NDArray[np.float64]


class Course(NamedTuple):
    """Given states (n, plant states) of tests with samples ``period`` apart, SI.

    ``begins`` (n,) is 1 where effects begin as they declare, ``time`` (n,), ``direction`` (n,) what stands for the sides of all
    contacts, ``inputs`` (n, inputs) in the plant's order, which hold from each sample to the next.
    """

    period: float
    begins: NDArray[np.int64]
    time: Array
    direction: Array
    states: Array
    inputs: Array


class Along(NamedTuple):
    """Rates (n, plant states) at each sample, and one sample later under the same inputs; readings (n, channels). SI."""

    before: Array
    after: Array
    readings: Array


@dataclass(frozen=True)
class Rates:
    """The rates of a composition, compiled without an integrator."""

    composition: Composition

    @cached_property
    def kernel(self) -> ModuleType:
        """The compiled kernel."""
        return load_kernel(rates_kernel_source(self.composition))

    @cached_property
    def users_files(self) -> str:
        """The effects that are files of the user's, in words; empty where all are ours."""
        return users_files(self.composition.effects)

    @limited
    def along(self, p: Array, course: Course, opened: frozenset[str] = frozenset()) -> Along:
        """Return rates and readings along a course with the parameters p, the gates of effects ``opened`` among them."""
        composition, n = self.composition, len(course.time)
        plain, total = len(composition.plant.states), len(composition.states)
        own = np.array(open_states(composition, set(opened)), dtype=np.int64)
        before, after, shown = np.empty((n, plain)), np.empty((n, plain)), np.empty((n, len(composition.measured)))
        after[-1] = 0.0
        self.kernel.rates_along(
            course.period, course.begins, own, course.time, course.direction, np.ascontiguousarray(course.states),
            np.ascontiguousarray(course.inputs), p, before, after, shown, np.zeros((4, total)),
        )  # fmt: skip
        return Along(before, after, shown)
