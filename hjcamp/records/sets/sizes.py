"""A column that is as large as a wrong unit makes it next to all other logs of a set, or an input that is dead in one log alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from hjcamp.errors import counted
from hjcamp.model.declare.field import Field
from hjcamp.model.language.field_table import fields_of
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.plausible import DRIVEN, FAR, MOST_GEARED, NEARLY, Finding, wrong_unit
from hjcamp.records.sets.course import input_fields
from hjcamp.records.sets.glance import Glance, Size
from hjcamp.records.units import units_of

# Of two conditions nothing says which is wrong; of three one may be the only one of its kind.
FEWEST_OTHERS = 3


def unlike_sizes(logs: Sequence[Glance]) -> Iterator[tuple[TestLog, Finding]]:
    """Yield each log one column of which is unlike that of all logs of other conditions, 3 or more, while the rest is as theirs.

    It may be in another unit where it is more than ten times larger or smaller than in each of them, a unit's factor brings it among
    them, and it is no noise. An input may be dead where it keeps one value, and what is measured moves as it does there.
    """
    plant = plant_of(logs[0].log.metadata, str(logs[0].log.path))
    table = fields_of(plant)
    known = [one for one in logs if one.sizes]
    if len({one.log.condition_key for one in known}) <= FEWEST_OTHERS:
        return
    names = set.intersection(*(set(one.sizes) for one in known))
    driven = () if plant.channels else names.intersection(input_fields(plant).values())
    still = {name: [one for one in known if one.sizes[name].move == 0.0] for name in driven}
    for log in known:
        others = [one.sizes for one in known if one.log.condition_key != log.log.condition_key]
        columns = {name: (log.sizes[name], [each[name] for each in others]) for name in sorted(names)}
        for name, (size, elsewhere) in columns.items():
            rest = [column for other, column in columns.items() if other != name]
            if text := _in_other_unit(table.field(name), size, elsewhere, rest):
                yield log.log, Finding(name, text, False, kind="unit")
            elif still.get(name) == [log] and rest and all(map(_moves, rest)):
                why = f"although it changes in {_count(elsewhere)}, and all else moves as it does there"
                text = f"'{name}' keeps one value in all {log.samples} samples, {why} (not connected, or held on purpose)"
                yield log.log, Finding(name, text, False, kind="constant")


Column = tuple[Size, Sequence[Size]]


def _in_other_unit(field: Field, size: Size, others: Sequence[Size], rest: Sequence[Column]) -> str:
    """Return in words which unit a column may be in, where nothing else is as much larger or smaller as it is."""
    low, high = min(one.rms for one in others), max(one.rms for one in others)
    constant = size.move == 0.0
    if (
        not (low and size.rms)
        or low / FAR <= size.rms <= FAR * high
        or any((one.move == 0.0) is not constant for one in others)
    ):
        return ""
    if size.steps > DRIVEN * MOST_GEARED * size.move:
        return ""  # noise, as an input has that nothing drives
    factors = {unit: one.factor for unit, one in units_of(field).items() if not one.shift and one.factor != 1.0}
    fits = {unit: factor for unit, factor in factors.items() if low / NEARLY <= size.rms * factor <= NEARLY * high}
    if not fits or not rest:
        return ""
    unit = min(fits, key=lambda one: abs(math.log(fits[one] * size.rms / math.sqrt(low * high))))
    if not all(_moves(column, math.sqrt(max(fits[unit], 1.0 / fits[unit]))) for column in rest):
        return ""
    times = size.rms / (low if size.rms < low else high)
    than = f"{times:.3g} times what it does in {_count(others)} (rms), where all else is as large"
    return wrong_unit(field, size.rms, than, unit, fits[unit])


def _moves(column: Column, within: float = math.sqrt(FAR)) -> bool:
    """Whether a column moves as in the others, but for a factor."""
    size, others = column
    moves = [one.move for one in others]
    return min(moves) / within <= size.move <= max(moves) * within


def _count(others: Sequence[Size]) -> str:
    return f"the {counted(len(others), 'log')} of other conditions"
