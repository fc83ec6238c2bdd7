"""What a sound log of the plant may hold: values, units and sensors that cannot be, each named with its likely cause."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.parameter import Channel
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.records.log import FIELDS, TestLog
from hjcamp.records.units import units_of
from hjcamp.yaml_file import yaml_values

PLANT = PumpJoint
CONFIGURATION = "config.yaml"
# So few samples of a test are single ones that went wrong; more of them are the column.
FEW = 0.01
# What is geared moves by 0.15 to 1.1 of what drives it in all our campaigns; a wrong unit is off by ten and more.
LEAST_GEARED, MOST_GEARED = 0.05, 4.0
MOVES = math.radians(20)
NEARLY = 5.0
LEAST_SIZE = 0.02
BLOCKED = "blocked"


@dataclass(frozen=True)
class Finding:
    """One thing in a log that cannot be; with ``refused`` no analysis of it means anything."""

    field: str
    text: str
    refused: bool

    @property
    def line(self) -> str:
        """The finding in one line: its level, then what it is."""
        return f"{'error' if self.refused else 'warning'}: {self.text}"


def findings(log: TestLog) -> list[Finding]:
    """Return what is not plausible in a log, what must be refused first."""
    found = [one for channel in PLANT.channels for one in _of_channel(log, channel)]
    for known in PLANT.inputs.values():
        if known.field in log.columns:
            found += _outside(known.field, log, *known.plausible, refused=False)
    found += _geared(log, {one.field for one in found})
    found += _configuration(log.attachments)
    return sorted(found, key=lambda one: not one.refused)


def refuse_implausible(log: TestLog, where: str) -> list[Finding]:
    """Return the warnings of a log; raises UsageError, one line, where it holds what cannot be."""
    found = findings(log)
    refused = [one for one in found if one.refused]
    if refused:
        more = f" (and {len(refused) - 1} more of its columns)" if len(refused) > 1 else ""
        raise UsageError(f"{where}: {refused[0].text}{more}")
    return found


def _of_channel(log: TestLog, channel: Channel) -> Iterator[Finding]:
    low, high = (one * channel.log_scale for one in channel.plausible)
    for name in (channel.field, *channel.along):
        if name in log.columns:
            yield from _outside(name, log, low, high, refused=name == channel.field)
    values = log.columns.get(channel.field)
    if channel.noise and values is not None and len(values) > 1 and np.ptp(values) == 0.0:
        text = f"'{channel.field}' is {values[0]:g} {_unit(channel.field)} in all {len(values)} samples; a sensor has noise"
        yield Finding(channel.field, f"{text} (not connected, or a number written in its place)", True)


def _outside(name: str, log: TestLog, low: float, high: float, refused: bool) -> Iterator[Finding]:
    """Say where a column leaves its range, with the unit that it looks like or the single samples that are wrong."""
    values = log.columns[name]
    out = (values < low) | (values > high)
    number = int(out.sum())
    if not number:
        return
    unit, first = _unit(name), int(np.argmax(out))
    held = f"a sound log stays within {low:g} and {high:g} {unit}"
    if number <= FEW * len(values):
        some = "single sample is" if number == 1 else "samples are"
        time = log.columns["time_s"][first]
        text = f"'{name}': {number} {some} off, {values[first]:.4g} {unit} at sample {first} (time {time:.6g} s)"
        yield Finding(name, f"{text}; {held}; looks like a spike of the logger or the sensor", refused)
        return
    cause = _likely(name, values, low, high)
    yield Finding(name, f"'{name}' reaches {values[np.argmax(np.abs(values))]:.4g} {unit}; {held}; {cause}", refused)


def _likely(name: str, values: np.ndarray, low: float, high: float) -> str:
    """Return which units a column that is too large looks like: those that bring it into its range, and not next to 0."""
    size = float(np.quantile(np.abs(values), 0.99))
    fits = [
        f"{unit}: {1.0 / factor:.4g} times too large"
        for unit, factor in units_of(name).items()
        if low <= float(values.min()) * factor and LEAST_SIZE * high <= size * factor <= high
    ]
    return f"looks like {' or '.join(fits)}" if fits else "looks like another quantity"


def _geared(log: TestLog, wrong: set[str]) -> Iterator[Finding]:
    """Say where a column moves far less or far more than what drives it lets it; not of columns that are wrong already."""
    for name, (driver, ratio) in PLANT.geared.items():
        channels = {channel.field: channel for channel in PLANT.channels}
        source = next((one for one in (driver, *channels[driver].along) if one in log.columns), None)
        if source is None or name not in log.columns or not wrong.isdisjoint((name, source)):
            continue
        columns = log.command_phase
        moved = float(np.ptp(columns[name])) / channels[name].log_scale
        driven = ratio * float(np.ptp(columns[source])) / channels[driver].log_scale
        count = PLANT.parameters[str(channels[name].counts)].default
        if driven > MOVES and moved == 0.0:
            if not _blocked(log):
                text = f"'{name}' never changes although '{source}' moves (blocked, or its encoder is lost)"
                yield Finding(name, text, False)
        elif driven > MOVES and moved < LEAST_GEARED * driven and len(np.unique(columns[name])) > 3 + 2 * moved / count:
            yield _slow(name, source, moved / driven, "follows")
        elif moved > MOVES and moved > MOST_GEARED * driven:
            yield _slow(source, name, driven / moved, "drives")


def _slow(name: str, other: str, share: float, does: str) -> Finding:
    """Return the finding of a column that moves only ``share`` of what the other one lets it."""
    fits = {unit: factor for unit, factor in units_of(name).items() if 1 / NEARLY < factor * share < NEARLY}
    unit = min(fits, key=lambda one: abs(math.log(fits[one] * share)), default=None)
    looks = "another quantity" if unit is None else f"{unit}: {fits[unit]:.4g} times too small"
    if share == 0.0:
        return Finding(name, f"'{name}' never changes although '{other}', which it {does}, moves", False)
    text = f"'{name}' moves {share:.2g} of what '{other}', which it {does}, lets expect"
    return Finding(name, f"{text}; looks like {looks}", False)


def _configuration(attachments: Mapping[str, bytes]) -> Iterator[Finding]:
    for place in _not_finite(_read(attachments), "", set()):
        text = f"the attached {CONFIGURATION} cannot be what ran: {place} is not a finite number"
        yield Finding(CONFIGURATION, text, False)


def _blocked(log: TestLog) -> bool:
    joint = _read(log.attachments).get("joint")
    return isinstance(joint, Mapping) and joint.get("name") == BLOCKED


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


def _unit(name: str) -> str:
    return next((field.unit for field in FIELDS if field.name == name), "")
