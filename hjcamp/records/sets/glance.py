"""What is kept of a log to look at a set of many: which fields it has, how large its readings are, and a few of these."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from hjcamp.model.declare.parameter import Input
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.log import TestLog
from hjcamp.records.noise import step_of
from hjcamp.records.of_plant import plant_of
from hjcamp.records.sets.course import Course, courses_of, input_fields
from hjcamp.records.sets.probe import Probe, probe_of, rounding

Sizes = dict[str, tuple[float, float]]
# Two logs are looked at where mean and spread of each column agree within this part of its spread.
CLOSE = 0.02


@dataclass(frozen=True, eq=False)
class Glance:
    """A log, its ``fields``, the optional inputs that ``moved`` from their defaults, mean and deviation of its readings, a ``probe`` of
    the ``probed`` one with its step, and the earlier logs of other conditions that it ``may_be`` a copy of.
    """

    log: TestLog
    fields: frozenset[str]
    samples: int
    moved: frozenset[str] = frozenset()
    sizes: Sizes = field(default_factory=dict)
    probed: str = ""
    probe: Probe | None = None
    step: float = 0.0
    may_be: tuple[TestLog, ...] = ()


def glance_at(log: TestLog, earlier: Iterable[Glance] = ()) -> Glance:
    """Return what is kept of a log, of which ``earlier`` ones it may be a copy; one that is no single test has no readings here."""
    columns, plant = log.columns, plant_of(log.metadata, str(log.path))
    moved = {
        name
        for name, given in optional_inputs(plant).items()
        if name in columns and np.any(columns[name] != given.default * unit_of_field(name, f"plant {plant.name}").scale)
    }
    found = Glance(log, frozenset(columns), log.samples, frozenset(moved))
    for one in courses_of([log]):
        probed = max(one.measured, key=lambda name: len(np.unique(one.columns[name])))
        sizes = {name: size_of(one.columns[name]) for name in one.measured}
        values = one.columns[probed]
        found = replace(found, sizes=sizes, probed=probed, probe=probe_of(values), step=step_of(values))
        return replace(found, may_be=tuple(each.log for each in earlier if _may_be(one, sizes, each)))
    return found


def _may_be(one: Course, sizes: Sizes, other: Glance) -> bool:
    """Whether readings of another log are found in a test of another condition."""
    if other.probe is None or other.probed not in one.measured or one.condition == other.log.condition_key:
        return False
    values = one.columns[other.probed]
    return look_the_same(sizes, other.sizes) and bool(len(other.probe.found_in(values, rounding(values, other.step))))


def look_the_same(one: Sizes, other: Sizes) -> bool:
    """Whether mean and spread of each column that two logs share nearly agree."""
    shared = one.keys() & other.keys()
    return bool(shared) and all(
        max(abs(one[name][0] - other[name][0]), abs(one[name][1] - other[name][1])) <= CLOSE * max(one[name][1], other[name][1])
        for name in shared
    )


def size_of(values: np.ndarray) -> tuple[float, float]:
    """Return mean and standard deviation of readings (n,)."""
    return float(values.mean()), float(values.std())


def optional_inputs(plant: type[Plant]) -> dict[str, Input]:
    """Return the inputs that a log may lack, by their fields."""
    return {field: plant.inputs[name] for name, field in input_fields(plant).items() if not plant.inputs[name].required}
