"""What a log says of its test, as far as logs of one plant are compared: its columns in the command phase."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import field_of
from hjcamp.records.log import SIMULATION, TestLog, parted
from hjcamp.records.noise import step_of, white_noise
from hjcamp.records.of_plant import plant_of
from hjcamp.records.plausible import watched_columns

Array = NDArray[np.float64]
# Of what a column does (standard deviation): smaller differences are rounding.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Course:
    """One test: ``columns`` by name (n,), of which some are ``measured``, and some ``commanded`` whatever is measured."""

    log: TestLog
    columns: dict[str, Array]
    measured: tuple[str, ...]
    commanded: tuple[str, ...]

    @property
    def where(self) -> str:
        """The log's file, or its condition where it has none."""
        return str(self.log.path or self.condition)

    @property
    def condition(self) -> str:
        """The condition, equal for repetitions."""
        return self.log.condition_key

    @property
    def simulated(self) -> bool:
        """Whether a simulation made it."""
        return self.log.metadata.get("backend") == SIMULATION

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(next(iter(self.columns.values())))

    @cached_property
    def steps(self) -> dict[str, float]:
        """The step of each column, 0 where none counts."""
        return {name: step_of(values) for name, values in self.columns.items()}

    @cached_property
    def rounding(self) -> dict[str, float]:
        """By how much each column may differ from its copy: by half its last digit, or by a millionth of what it does."""
        return {name: max(0.5 * self.steps[name], ROUNDING * float(np.std(values))) for name, values in self.columns.items()}

    @cached_property
    def smallest(self) -> dict[str, float]:
        """The standard deviation that rounding and noise give each column."""
        return {
            name: max(
                self.steps[name] / math.sqrt(12.0), white_noise(values, self.steps[name]), ROUNDING * float(np.std(values))
            )
            for name, values in self.columns.items()
        }

    @cached_property
    def _ranks(self) -> dict[str, tuple[NDArray[np.intp], Array]]:
        return {}

    def near(self, name: str, reading: float, within: float) -> NDArray[np.intp]:
        """Return the samples of a column that differ from a ``reading`` by ``within`` at most, but for rounding; sorted once."""
        if name not in self._ranks:
            order = np.argsort(self.columns[name], kind="stable")
            self._ranks[name] = order, self.columns[name][order]
        order, ranked = self._ranks[name]
        margin = within + ROUNDING * (within + abs(reading))
        first, last = ranked.searchsorted(reading - margin, "left"), ranked.searchsorted(reading + margin, "right")
        return np.sort(order[first:last])

    @cached_property
    def distinct(self) -> dict[str, int]:
        """How many different readings each column has."""
        return {name: len(np.unique(values)) for name, values in self.columns.items()}


def courses_of(logs: Iterable[TestLog]) -> list[Course]:
    """Return the courses of logs whose command phase is one stretch with readings; others say by themselves what is wrong."""
    found = []
    for log in logs:
        columns = log.columns
        if parted(columns) or len(log.command_phase["time_s"]) < 2:
            continue
        measured, along, inputs = _names(plant_of(log.metadata, str(log.path)))
        phase = log.command_phase
        own = {name: phase[name] for name in (*measured, *along, *inputs) if name in phase and np.all(np.isfinite(phase[name]))}
        references = [name for name in along if name.startswith("reference_") and name in own]
        commanded = references or [name for name in inputs if name in own]
        shown = tuple(name for name in measured if name in own)
        if shown:
            found.append(Course(log, own, shown, tuple(commanded)))
    return found


def input_fields(plant: type[Plant]) -> dict[str, str]:
    """Return the field of each input that a log of a plant may hold, by its name."""
    return {name: one.field or field_of(one.name, one.unit, plant.name) for name, one in plant.given_inputs().items()}


def by_condition(courses: Sequence[Course]) -> list[list[Course]]:
    """Return the courses, those of one condition, which are repetitions of each other, in one list."""
    groups: dict[str, list[Course]] = {}
    for one in courses:
        groups.setdefault(one.condition, []).append(one)
    return list(groups.values())


def _names(plant: type[Plant]) -> tuple[list[str], list[str], list[str]]:
    watched = list(watched_columns(plant))
    measured = [one.name for one in watched]
    along = [name for one in watched for name in one.along]
    return measured, along, [name for name in input_fields(plant).values() if name not in (*measured, *along)]
