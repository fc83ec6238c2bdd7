"""What is kept of a log to look at a set of many: which fields it has, and how large its readings are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hjcamp.model.declare.parameter import Input
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.sets.course import courses_of, input_fields

Sizes = dict[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Glance:
    """A log, its ``fields``, the optional inputs that ``moved`` from their defaults, and mean and deviation of its readings."""

    log: TestLog
    fields: frozenset[str]
    samples: int
    moved: frozenset[str]
    sizes: Sizes


def glance_at(log: TestLog) -> Glance:
    """Return what is kept of a log; its readings have no sizes where they are no single test."""
    columns, plant = log.columns, plant_of(log.metadata, str(log.path))
    sizes = {name: size_of(one.columns[name]) for one in courses_of([log]) for name in one.measured}
    moved = {
        field
        for field, given in optional_inputs(plant).items()
        if field in columns and np.any(columns[field] != given.default * unit_of_field(field, f"plant {plant.name}").scale)
    }
    return Glance(log, frozenset(columns), log.samples, frozenset(moved), sizes)


def size_of(values: np.ndarray) -> tuple[float, float]:
    """Return mean and standard deviation of readings (n,)."""
    return float(values.mean()), float(values.std())


def optional_inputs(plant: type[Plant]) -> dict[str, Input]:
    """Return the inputs that a log may lack, by their fields."""
    return {field: plant.inputs[name] for name, field in input_fields(plant).items() if not plant.inputs[name].required}
