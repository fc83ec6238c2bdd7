"""The fields of a plant's logs: time, phase, what is wanted, what is measured, what is given."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.field import PHASE, TIME, Field
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import field_of, unit_of_field

# Protobuf's own limit is far higher; beyond this a tag takes three bytes.
MOST_FIELDS = 2047


@dataclass(frozen=True)
class FieldTable:
    """The fields of the logs of one plant, in order; the place in it (from 1) is the protobuf field number.

    Every log has the required ones and, where there are any, one of ``one_of``.
    """

    plant: str
    fields: tuple[Field, ...]
    one_of: tuple[str, ...] = ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names in order."""
        return tuple(field.name for field in self.fields)

    @cached_property
    def required(self) -> tuple[str, ...]:
        """The names that every log has."""
        return tuple(field.name for field in self.fields if field.required)

    def number(self, name: str) -> int:
        """Return the protobuf number of a field: its place in the table, from 1."""
        return self.names.index(name) + 1

    def field(self, name: str, where: str = "") -> Field:
        """Return the field called ``name``; raises ``UsageError`` where there is none."""
        if name not in self.names:
            raise unknown("field", name, self.names, where or f"the logs of plant {self.plant}")
        return self.fields[self.names.index(name)]


def fields_of(plant: type[Plant]) -> FieldTable:
    """Return the field table of a plant: its own ``fields``, else what its measured channels and inputs are called.

    Raises ``UsageError`` for a name without a unit, and for two fields of one name.
    """
    fields = plant.fields or tuple(_fields(plant))
    names = [field.name for field in fields]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"plant {plant.name}: two fields of its logs are called '{name}'; rename one of them")
    if len(fields) > MOST_FIELDS:
        raise UsageError(f"plant {plant.name}: {len(fields)} fields; a log has {MOST_FIELDS} at most")
    return FieldTable(plant.name, fields, plant.one_of)


def _phase(plant: type[Plant]) -> Field:
    """Return the field of the phases, by the names that the plant gives them."""
    if not (plant.phases_before or plant.phases_after):
        return PHASE
    names = [*(f"{number} {one.name}" for number, one in enumerate(plant.phases_before)), "2 rest", "3 command and control"]
    return replace(PHASE, text=", ".join([*names, *(f"4 {one.name}" for one in plant.phases_after)]))


def _fields(plant: type[Plant]) -> Iterator[Field]:
    where = f"plant {plant.name}"
    sensors = [(one.field, one.required, "") for one in plant.channels] or [
        (one.name, one.required, one.text) for one in plant.measured.values()
    ]
    measured = [Field(name, unit_of_field(name, where).shown, required, text) for name, required, text in sensors]
    references = [Field(f"reference_{one.name}", one.unit, False, f"what is wanted of {one.name}") for one in measured]
    yield from (TIME, _phase(plant), *references, *measured)
    for given in plant.given_inputs().values():
        # An input may be the column of something measured or wanted: that is said once.
        if given.field not in {one.name for one in (*references, *measured)}:
            name = given.field or field_of(given.name, given.unit, where)
            yield Field(name, unit_of_field(name, where).shown, given.required, given.text)
