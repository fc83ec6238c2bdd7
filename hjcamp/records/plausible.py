"""What a sound log of the plant may hold: values, units and sensors that cannot be, each named with its likely cause."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.declare.field import Field
from hjcamp.model.declare.parameter import Input, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import FieldTable, fields_of
from hjcamp.model.language.field_unit import field_of, unit_of_field
from hjcamp.records.glitch_words import MISSING, told_glitches, told_no_readings
from hjcamp.records.glitches import FEW, ROW
from hjcamp.records.log import TestLog, parted
from hjcamp.records.of_plant import plant_of
from hjcamp.records.units import units_of
from hjcamp.yaml_file import yaml_values

CONFIGURATION = "config.yaml"
# What is geared moves by 0.15 to 1.1 of what drives it in all our campaigns; a wrong unit is off by ten and more.
LEAST_GEARED, MOST_GEARED = 0.05, 4.0
MOVES = math.radians(20)
NEARLY = 5.0
LEAST_SIZE = 0.02
# A column that goes to so many times what its plant's file calls typical, or so small a part of it, may be in another unit.
FAR = 10.0
# What moves by so much of its whole range about a line in the second half of a test is driven; a shorter test is not judged.
DRIVEN, FEWEST = 0.05, 50


@dataclass(frozen=True)
class Finding:
    """One thing in a log that cannot be; with ``refused`` no analysis of it means anything.

    ``kind`` in a word or two: range, unit, spikes, saturation, constant, gaps, clock, copy, ...
    With ``of_all`` it says something where all logs of one set show it alone: one of them may well be of a small test.
    """

    field: str
    text: str
    refused: bool
    of_all: bool = False
    kind: str = "range"

    @property
    def line(self) -> str:
        """The finding in one line: its level, then what it is."""
        return f"{'error' if self.refused else 'warning'}: {self.text}"


@dataclass(frozen=True)
class Watched:
    """A column, what a sound log keeps it within (in its own unit), whether it must not stand still, and what goes with it."""

    name: str
    low: float
    high: float
    analog: bool
    along: tuple[str, ...] = ()


def findings(log: TestLog) -> list[Finding]:
    """Return what is not plausible in a log of its plant, what must be refused first."""
    plant = plant_of(log.metadata, str(log.path or "this log"))
    table = fields_of(plant)
    found = [one for watched in watched_columns(plant) for one in _of_measured(log, table, watched)]
    for known in plant.given_inputs().values():
        name = known.field or field_of(known.name, known.unit, plant.name)
        if name in log.columns:
            scale = unit_of_field(name, plant.name).scale
            low, high = (end * scale for end in known.plausible)
            found += _outside(name, log, table, low, high, refused=False)
    found += _dead_inputs(log, plant)
    found += _untypical(log, plant, {one.field for one in found})
    found += [] if parted(log.columns) else _geared(log, plant, {one.field for one in found})
    found += _configuration(log.attachments)
    found += [Finding("phase", fault, True, kind="phase")] if (fault := parted(log.columns)) else []
    return sorted(found, key=lambda one: not one.refused)


def watched_columns(plant: type[Plant]) -> Iterator[Watched]:
    """Yield what a plant measures; a required sensor that is not said to count must not stand still."""
    for channel in plant.channels:
        low, high = (end * channel.log_scale for end in channel.plausible)
        yield Watched(channel.field, low, high, channel.noise is not None, channel.along)
    for one in () if plant.channels else plant.measured.values():
        scale = unit_of_field(one.name, plant.name).scale
        low, high = (end * scale for end in one.plausible)
        analog = one.counts is None and (one.required or one.noise is not None)
        yield Watched(one.name, low, high, analog, (f"reference_{one.name}",))


def refuse_implausible(log: TestLog, where: str) -> list[Finding]:
    """Return the warnings of a log; raises UsageError, one line, where it holds what cannot be."""
    found = findings(log)
    refused = [one for one in found if one.refused]
    if refused:
        more = f" (and {len(refused) - 1} more of its columns)" if len(refused) > 1 else ""
        raise UsageError(f"{where}: {refused[0].text}{more}")
    return found


def without_small_tests(found: Sequence[list[Finding]]) -> list[list[Finding]]:
    """Return the findings of each log without those that hold for all logs of the set alone, where some of these do not show them."""
    shown = [{one.field for one in own if one.of_all} for own in found]
    common = set.intersection(*shown) if shown else set()
    return [[one for one in own if not one.of_all or one.field in common] for own in found]


def _of_measured(log: TestLog, table: FieldTable, watched: Watched) -> Iterator[Finding]:
    values, unit = log.columns.get(watched.name), table.field(watched.name).unit
    absent = told_no_readings(watched.name, values, unit) if values is not None else ""
    found = [
        one
        for name in (watched.name, *watched.along)
        if name in log.columns
        for one in _outside(name, log, table, watched.low, watched.high, refused=name == watched.name)
    ]
    own = [one for one in found if one.field == watched.name]
    yield from (one for one in found if one not in own)
    if own or absent:
        more = f"; where it stands for no reading: {MISSING} in the map" if absent else ""
        yield from (replace(one, text=one.text + more) for one in own)
        yield from () if own else (Finding(watched.name, absent, False, kind="no reading"),)
        return
    if watched.analog and values is not None and len(values) > 1 and np.ptp(values) == 0.0:
        text = f"'{watched.name}' is {values[0]:g} {unit} in all {len(values)} samples; a sensor has noise"
        yield Finding(watched.name, f"{text} (not connected, or a number written in its place)", True, kind="constant")
    elif values is not None:
        times = log.columns["time_s"]
        told = told_glitches(watched.name, values, times, unit, watched.analog, watched.low, watched.high)
        yield from (Finding(watched.name, text, False, kind=kind) for kind, text in told)


def _dead_inputs(log: TestLog, plant: type[Plant]) -> Iterator[Finding]:
    """Say where all inputs stay as they are although what is measured goes on to move, beyond a line, to the end."""
    given = [one.field or field_of(one.name, one.unit, plant.name) for one in plant.given_inputs().values()]
    inputs = [name for name in given if name in log.columns]
    if plant.channels or not inputs or any(np.ptp(log.columns[name]) for name in inputs):
        return
    half = log.columns["time_s"][log.samples // 2 :]
    for one in plant.measured.values():
        values = log.columns.get(one.name)
        if values is None or len(half) < FEWEST or not np.ptp(values):
            continue
        later = values[log.samples // 2 :]
        line = np.polyval(np.polyfit(half, later, 1), half)
        # smooth, as what moves is: the noise of a sensor is not
        rms, rough = float(np.std(later - line)), float(np.std(np.diff(later - line)))
        if rms > DRIVEN * float(np.ptp(values)) and rough < DRIVEN * MOST_GEARED * rms:
            text = f"'{inputs[0]}' is {log.columns[inputs[0]][0]:g} in all {log.samples} samples although '{one.name}' moves to the end"
            yield Finding(inputs[0], f"{text} (not connected, another column, or a free motion)", False, kind="constant")
            return


def _outside(name: str, log: TestLog, table: FieldTable, low: float, high: float, refused: bool) -> Iterator[Finding]:
    """Say where a column leaves its range, with the unit that it looks like or the single samples that are wrong."""
    values = log.columns[name]
    out = (values < low) | (values > high)
    number = int(out.sum())
    if not number:
        return
    unit, first = table.field(name).unit, int(np.argmax(out))
    held = f"a sound log stays within {low:g} and {high:g} {unit}"
    if number <= FEW * len(values) and not _lasts(out):
        some = "single sample is" if number == 1 else "samples are"
        time = log.columns["time_s"][first]
        text = f"'{name}': {number} {some} off, {values[first]:.4g} {unit} at sample {first} (time {time:.6g} s)"
        held += "; looks like a spike of the logger or the sensor ('spikes: interpolate' in the map of an import)"
        yield Finding(name, f"{text}; {held}", refused, kind="spikes")
        return
    peak = values[np.argmax(np.abs(values))]
    if number <= len(values) // 2 and abs(peak) <= NEARLY * max(abs(low), abs(high)):
        # A wrong unit takes most of a test out of its range; a rig that pushes harder than ours stays near it.
        yield Finding(name, f"'{name}' reaches {peak:.4g} {unit}; {held}", False)
        return
    cause = _likely(table, name, values, low, high)
    yield Finding(name, f"'{name}' reaches {peak:.4g} {unit}; {held}; {cause}", refused)


def _lasts(out: np.ndarray) -> bool:
    """Whether more than `ROW` samples in a row are marked."""
    return bool(np.any(np.convolve(out, np.ones(ROW + 1), "valid") > ROW)) if len(out) > ROW else False


def _likely(table: FieldTable, name: str, values: np.ndarray, low: float, high: float) -> str:
    """Return which units a column that is too large looks like: those that bring it into its range, and not next to 0."""
    size = float(np.quantile(np.abs(values), 0.99))
    fits = [
        f"{unit}: {1.0 / one.factor:.4g} times too large"
        for unit, one in units_of(table.field(name)).items()
        if not one.shift and low <= float(values.min()) * one.factor and LEAST_SIZE * high <= size * one.factor <= high
    ]
    return f"looks like {' or '.join(fits)}" if fits else "looks like another quantity"


def _untypical(log: TestLog, plant: type[Plant], wrong: set[str]) -> Iterator[Finding]:
    """Say which columns are as large as a wrong unit makes them relative to what the plant's file calls typical.

    A file that says nothing is not heeded, nor one whose typical size no other unit explains.
    """
    table = fields_of(plant)
    shown = () if plant.channels else [one for one in plant.measured.values() if one.of in plant.states]
    sizes: dict[str, State | Input] = {one.name: plant.states[one.of] for one in shown}
    sizes |= {one.field or field_of(one.name, one.unit, plant.name): one for one in plant.given_inputs().values()}
    for name, known in sizes.items():
        # a ratio is about 1 where the file does not say it
        declared = known.typical != type(known).typical or name.endswith("_ratio")
        if name not in log.columns or name in wrong or not declared:
            continue
        typical = abs(known.typical) * unit_of_field(name, plant.name).scale
        times = float(np.quantile(np.abs(log.columns[name]), 0.99)) / typical
        if times == 0.0 or 1.0 / FAR < times < FAR:
            continue
        fits = {
            unit: one.factor
            for unit, one in units_of(table.field(name)).items()
            if not one.shift and 1.0 / NEARLY < one.factor * times < NEARLY
        }
        if fits:
            unit = min(fits, key=lambda one: abs(math.log(fits[one] * times)))
            than = f"{times:.3g} times its typical size in the plant's file"
            yield Finding(
                name, wrong_unit(table.field(name), times * typical, than, unit, fits[unit]), False, of_all=True, kind="unit"
            )


def wrong_unit(field: Field, size: float, than: str, unit: str, factor: float) -> str:
    """Return in words that a column, ``than`` usual, may be in ``unit``, ``factor`` of its own, and which mistake looks the same."""
    plain = field.unit == "1"
    own = "a ratio" if plain else field.unit
    similar = (
        name for name, one in units_of(field).items() if not one.shift and math.isclose(one.factor * factor, 1.0, rel_tol=1e-6)
    )
    taken = " or ".join([f"{unit} read as {own}", *(f"{own} as {name}" for name in similar)])
    off = f"{max(factor, 1.0 / factor):.4g} times too {'small' if factor > 1.0 else 'large'}"
    return (
        f"'{field.name}' goes to {size:.4g}{'' if plain else f' {own}'}, {than}; "
        f"if its unit is wrong, it is {off}, as {taken} would be"
    )


def _geared(log: TestLog, plant: type[Plant], wrong: set[str]) -> Iterator[Finding]:
    """Say where a column moves far less or far more than what drives it lets it; not of columns that are wrong already."""
    table = fields_of(plant)
    for name, (driver, ratio) in plant.geared.items():
        channels = {channel.field: channel for channel in plant.channels}
        source = next((one for one in (driver, *channels[driver].along) if one in log.columns), None)
        if source is None or name not in log.columns or not wrong.isdisjoint((name, source)):
            continue
        columns = log.command_phase
        moved = float(np.ptp(columns[name])) / channels[name].log_scale
        driven = ratio * float(np.ptp(columns[source])) / channels[driver].log_scale
        count = plant.parameters[str(channels[name].counts)].default
        if driven > MOVES and moved == 0.0:
            if not plant.blocked(_read(log.attachments)):
                text = f"'{name}' never changes although '{source}' moves (blocked, or its encoder is lost)"
                yield Finding(name, text, False, kind="constant")
        elif driven > MOVES and moved < LEAST_GEARED * driven and len(np.unique(columns[name])) > 3 + 2 * moved / count:
            yield _slow(table, name, source, moved / driven, "follows")
        elif moved > MOVES and moved > MOST_GEARED * driven:
            yield _slow(table, source, name, driven / moved, "drives")


def _slow(table: FieldTable, name: str, other: str, share: float, does: str) -> Finding:
    """Return the finding of a column that moves only ``share`` of what the other one lets it."""
    units = units_of(table.field(name)).items()
    fits = {unit: one.factor for unit, one in units if 1 / NEARLY < one.factor * share < NEARLY}
    unit = min(fits, key=lambda one: abs(math.log(fits[one] * share)), default=None)
    looks = "another quantity" if unit is None else f"{unit}: {fits[unit]:.4g} times too small"
    if share == 0.0:
        return Finding(name, f"'{name}' never changes although '{other}', which it {does}, moves", False, kind="constant")
    text = f"'{name}' moves {share:.2g} of what '{other}', which it {does}, lets expect"
    return Finding(name, f"{text}; looks like {looks}", False, kind="unit")


def _configuration(attachments: Mapping[str, bytes]) -> Iterator[Finding]:
    for place in _not_finite(_read(attachments), "", set()):
        text = f"the attached {CONFIGURATION} cannot be what ran: {place} is not a finite number"
        yield Finding(CONFIGURATION, text, False, kind="configuration")


def _read(attachments: Mapping[str, bytes]) -> Mapping[str, Any]:
    try:
        content = yaml_values(attachments.get(CONFIGURATION, b""))
    except UsageError:
        return {}
    return content if isinstance(content, Mapping) else {}


def _not_finite(content: Any, place: str, seen: set[int]) -> Iterator[str]:
    """Yield the places of numbers that are none; what YAML's aliases hold again is looked at once."""
    if isinstance(content, float) and not math.isfinite(content):
        yield place
    elif isinstance(content, Mapping | list) and id(content) not in seen:
        seen.add(id(content))
        named = content.items() if isinstance(content, Mapping) else enumerate(content)
        for name, value in named:
            yield from _not_finite(value, f"{place}.{name}" if place else str(name), seen)
