"""Guess the map of an import from what a file calls its columns; what is open stays a question mark."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.declare.field import Field
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import FieldTable, fields_of
from hjcamp.model.language.field_unit import FIELD_UNITS, MEANT, unit_shown
from hjcamp.records.elsewhere.import_map import OPEN, ColumnRule, ImportMap
from hjcamp.records.elsewhere.map_values import HIGHEST_SAMPLING_HZ
from hjcamp.records.elsewhere.reader import Column
from hjcamp.records.elsewhere.readers import reader_of
from hjcamp.records.elsewhere.tables import check_file, read_table
from hjcamp.records.elsewhere.text_head import unit_in
from hjcamp.records.units import conversion_to_field, is_unit

TIME = "time_s"
#: What people call a quantity, by the SI unit of a field.
WORDS: dict[str, tuple[str, ...]] = {
    "s": ("t", "time", "zeit", "timestamp", "stamp", "elapsed", "seconds", "sec", "temps", "tiempo"),
    "m": ("x", "y", "z", "s", "pos", "position", "displacement", "travel", "stroke", "weg", "level", "height", "h"),
    "rad": ("phi", "theta", "q", "angle", "winkel", "alpha", "rotation", "encoder"),
    "m/s": ("v", "vel", "velocity", "speed"),
    "rad/s": ("w", "omega", "speed", "rpm", "velocity", "qd"),
    "V": ("u", "v", "volt", "voltage", "spannung"),
    "A": ("i", "current", "strom", "amp"),
    "N": ("f", "force", "kraft", "load"),
    "N*m": ("m", "tau", "torque", "moment", "effort"),
    "Pa": ("p", "press", "pressure", "druck"),
    "K": ("temp", "temperature", "temperatur"),
    "m^3/s": ("q", "flow", "flowrate"),
    "W": ("power", "heat"),
}  # fmt: skip
NAMED, SAME, SHARED, WORD, UNIT = 4.0, 3.0, 2.0, 1.5, 1.0
CLEAR = 0.5  # a guess is made where it is that much better than the next
FINEST_S = 0.2  # steps between rows that are seconds where nothing says the unit
#: Units in which clocks of computers count from 1970 on, each with how many a second has; the years 2000 to 2100.
SINCE_1970 = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
THIS_CENTURY_S, SPREADSHEET_DAYS = (946_684_800.0, 4_102_444_800.0), (36_526.0, 73_051.0)


@dataclass(frozen=True)
class Guess:
    """The text of a map, the fields whose column or unit is open, and the columns that nothing was made of."""

    text: str
    open: tuple[str, ...]
    unused: tuple[str, ...]


@dataclass(frozen=True)
class _Named:
    """A column with its name in words and its unit, as far as the file says them."""

    column: Column
    name: str
    unit: str


def guess_map(source: Path, plant: type[Plant]) -> Guess:
    """Return the map of a file that its header suggests; raises UsageError for a file that cannot be read or has no columns."""
    check_file(source)
    reader, table = reader_of(source), fields_of(plant)
    rules = ImportMap(plant, table, {}, {}, None, False, str(source))
    columns = reader.columns(source, rules)
    if not columns:
        raise UsageError(
            f"{source}: no column of numbers was found; write the map by hand: hjcamp plants {plant.name} prints one"
        )
    parts: dict[tuple[str, str] | None, list[_Named]] = {}
    for one in columns:
        parts.setdefault(one.key, []).append(_named(one))
    found = {key: _matched(own, table) for key, own in parts.items()}
    most = max(len(one) for one in found.values())
    best = [key for key, one in found.items() if len(one) == most]
    key = best[0]
    keys: dict[str, object] = {key[0]: key[1] if len(best) == 1 else OPEN} if key else {}
    rules = replace(rules, **{key[0]: key[1]}) if key else rules  # type: ignore[arg-type]
    keys |= reader.keys(source, rules)
    known = replace(rules, **{name: value for name, value in keys.items() if value != OPEN})  # type: ignore[arg-type]
    chosen = {name: (one, _unit(one, table.field(name), source, known)) for name, one in found[key].items()}
    lacking = _rows_without_value(source, known, [one.column.name for one, _ in chosen.values()])
    keys |= {"gaps": OPEN} if lacking else {}
    return _written(source, plant, table, keys, chosen, parts[key], {"gaps": lacking})


def _rows_without_value(source: Path, known: ImportMap, columns: Sequence[str]) -> str:
    """Say in how many rows the columns lack a value; nothing where none does, or where the table is refused for something else."""
    asked = replace(known, rules={name: ColumnRule(name) for name in columns}, interpolate=True)
    with suppress(UsageError):
        if not columns:
            return ""
        values = np.stack(list(read_table(source, asked).columns.values()))
        lacking = int(np.isnan(values).any(axis=0).sum())
        return (
            f"{lacking} of {values.shape[1]} rows lack a value: interpolate fills them in, refuse does not" if lacking else ""
        )
    return ""


def _named(column: Column) -> _Named:
    """Return a column with its name and unit: of the file, in brackets behind the name, or at its end."""
    label = column.said or column.name
    name, unit = unit_in(label)
    unit = column.unit if is_unit(column.unit) else unit
    if unit in ("S", "MS", "US", "NS") and _words(name) & set(WORDS["s"]):
        unit = unit.casefold()  # in capitals; a time is in no siemens
    if not unit:
        parts = re.split(r"[_ ]", name)
        for first in range(1, len(parts)):
            end = "_".join(parts[first:])
            end = end.casefold() if len(end) == 1 else end
            suffix = end if end in FIELD_UNITS else MEANT.get(end.casefold(), "")
            alone = first == len(parts) - 1 and len(end) > 1 and is_unit(end)
            written = FIELD_UNITS[suffix].shown if suffix else end if alone else ""
            if written:
                return _Named(column, "_".join(parts[:first]), written)
    return _Named(column, name, unit)


def _matched(columns: Sequence[_Named], table: FieldTable) -> dict[str, _Named]:
    """Return the column of each field that is clearly meant by one, and no other field by that."""
    scores = {
        (place, field.name): score
        for place, one in enumerate(columns)
        for field in table.fields
        if field.name != "phase" and (score := _score(one, field)) > 0.0
    }
    found: dict[str, _Named] = {}
    for (place, name), score in sorted(scores.items(), key=lambda one: -one[1]):
        if name in found or columns[place] in found.values():
            continue
        taken = {columns.index(one) for one in found.values()}
        rivals = [
            other
            for (at, field), other in scores.items()
            if (at == place) != (field == name) and field not in found and at not in taken
        ]
        if score >= NAMED or all(score >= other + CLEAR for other in rivals):
            found[name] = columns[place]
    return found


def _score(one: _Named, field: Field) -> float:
    """Return how well a column fits a field; 0 where its unit is of another dimension."""
    if (one.column.said or one.column.name) == field.name:
        return NAMED + UNIT
    fits = 0.0
    if one.unit:
        try:
            conversion_to_field(field, one.unit, "")
        except UsageError:
            return 0.0
        fits = UNIT
    stem = field.name.removesuffix(f"_{unit_shown(field.unit).suffix}")
    said, meant = _words(one.name), _words(stem)
    if field.name == TIME:
        # several columns may be in seconds; a time is called so
        return SAME + fits if said & set(WORDS["s"]) else 0.0
    if said == meant:
        return SAME + fits
    if (said <= meant or meant <= said) and said:
        return SHARED + fits
    if not field.name.startswith("reference_") and said & set(WORDS.get(unit_shown(field.unit).si, ())):
        return WORD + fits
    return 0.0 if field.name.startswith("reference_") else fits


def _words(name: str) -> set[str]:
    """Return the words of a name in any way of writing: motorSpeed_2, Motor speed."""
    parts = re.sub(r"([a-z])([A-Z])", r"\1 \2", re.sub(r"[\d\W_]+", " ", name)).casefold().split()
    return set(parts)


def _unit(one: _Named, field: Field, source: Path, rules: ImportMap) -> str:
    """Return the unit of a column, a question mark where nothing says it; seconds where rows of a time are that close."""
    if one.unit:
        return one.unit
    if (one.column.said or one.column.name) == field.name or field.unit == "1":
        return field.unit
    if field.name == TIME:
        with suppress(UsageError):
            asked = replace(rules, rules={TIME: ColumnRule(one.column.name)}, interpolate=True)
            return _unit_of_times(read_table(source, asked).columns[one.column.name])
    return OPEN


def _unit_of_times(times: np.ndarray) -> str:
    """Return the unit of times (rows,) that their values say: since 1970, days of a spreadsheet, seconds where rows are close."""
    first, step = float(times[0]), float(np.median(np.diff(times)))
    for unit, in_a_second in SINCE_1970.items():
        if THIS_CENTURY_S[0] * in_a_second <= first < THIS_CENTURY_S[1] * in_a_second:
            return unit
    if SPREADSHEET_DAYS[0] <= first < SPREADSHEET_DAYS[1] and 0.0 < step < 1.0 / HIGHEST_SAMPLING_HZ:
        return "day"
    return "s" if 0.0 < step <= FINEST_S else OPEN


def _written(
    source: Path,
    plant: type[Plant],
    table: FieldTable,
    keys: dict[str, object],
    chosen: dict[str, tuple[_Named, str]],
    columns: Iterable[_Named],
    notes: Mapping[str, str],
) -> Guess:
    """Return the map as a text, with what is to be known of a key; a field that a log needs and no column has is open."""
    lines = [
        f"# Guessed from {source.name}; ? is open: write the column or unit that it is, or delete the line.",
        f"plant: {plant.name}",
        *(
            f"{name}: {json.dumps(value, ensure_ascii=False)}" + (f"  # {notes[name]}" if notes.get(name) else "")
            for name, value in keys.items()
        ),
    ]
    needed = {field.name for field in table.fields if field.required}
    needed |= set() if set(table.one_of) & set(chosen) else set(table.one_of[:1])
    left_open = [name for name, value in keys.items() if value == OPEN]
    has_times = bool({"topic"} & set(keys)) or source.suffix.casefold() == ".tdms"
    if TIME not in chosen and not has_times:
        lines.append(f"period_s: {json.dumps(OPEN)}  # s between rows, or map a column to {TIME}")
        left_open.append("period_s")
    lines.append("fields:")
    for field in table.fields:
        if field.name in chosen:
            one, unit = chosen[field.name]
            said = f"  # {one.column.said}" if one.column.said else ""
            column, quoted = (json.dumps(text, ensure_ascii=False) for text in (one.column.name, unit))
            lines.append(f"  {field.name}: {{column: {column}, unit: {quoted}}}{said}")
            left_open += [field.name] if unit == OPEN else []
        elif field.name in needed and field.name != TIME:
            lines.append(
                f"  {field.name}: {{column: {json.dumps(OPEN)}, unit: {json.dumps(field.unit)}}}  # {field.text}".rstrip(" #")
            )
            left_open.append(field.name)
    unused = [one.column.name for one in columns if one.column.name not in {each.column.name for each, _ in chosen.values()}]
    lines += [f"# columns that are not used: {', '.join(unused)[:2000]}"] if unused else []
    lines += ["metadata:", '  condition: "{file}"']
    lines += [f"  # {item.given}: {item.text or item.name}" for item in plant.parameters.values() if item.given]
    return Guess("\n".join(lines) + "\n", tuple(left_open), tuple(unused))
