"""What is kept of a log to look at a set of many: which fields it has, how large its readings are, and a few of these."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from hjcamp.model.declare.parameter import Input
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.sets.course import courses_of, input_fields
from hjcamp.records.sets.probe import Probed


class Size(NamedTuple):
    """The ``rms`` of readings, by how much they ``move`` (standard deviation), and that of the steps from one to the next."""

    rms: float
    move: float
    steps: float


@dataclass(frozen=True, eq=False)
class Glance:
    """A log, its ``fields``, the optional inputs that ``moved`` from their defaults, the sizes of its columns, what
    was ``probed`` of them, and the earlier logs that it ``may_be`` a copy of.
    """

    log: TestLog
    fields: frozenset[str]
    samples: int
    moved: frozenset[str] = frozenset()
    sizes: dict[str, Size] = field(default_factory=dict)
    probed: Probed | None = None
    may_be: tuple[TestLog, ...] = ()


def glance_at(log: TestLog, earlier: Iterable[Glance] = ()) -> Glance:
    """Return what is kept of a log, and of which ``earlier`` ones, which it was not looked at with, it may be a copy.

    One that is no single test has no readings here.
    """
    columns, plant = log.columns, plant_of(log.metadata, str(log.path))
    moved = {
        name
        for name, given in optional_inputs(plant).items()
        if name in columns and np.any(columns[name] != given.default * unit_of_field(name, f"plant {plant.name}").scale)
    }
    found = Glance(log, frozenset(columns), log.samples, frozenset(moved))
    for one in courses_of([log]):
        sizes = {name: size_of(values) for name, values in one.columns.items()}
        may_be = tuple(each.log for each in earlier if each.probed is not None and each.probed.may_be_in(one))
        return replace(found, sizes=sizes, probed=Probed.of(one), may_be=may_be)
    return found


def size_of(values: np.ndarray) -> Size:
    """Return the size of readings (n,)."""
    steps = np.diff(values)
    # the mean of equal numbers may not be one of them
    move = float(values.std()) if np.ptp(values) else 0.0
    return Size(float(np.sqrt(np.mean(values**2))), move, float(steps.std()))


def optional_inputs(plant: type[Plant]) -> dict[str, Input]:
    """Return the inputs that a log may lack, by their fields."""
    return {field: plant.inputs[name] for name, field in input_fields(plant).items() if not plant.inputs[name].required}
