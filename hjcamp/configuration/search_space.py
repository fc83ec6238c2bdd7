"""What a sweeper may choose from: the ranges and lists in the overrides of a sweep, checked before anything is run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from hydra.core.override_parser.types import ChoiceSweep, IntervalSweep, Override, RangeSweep

from hjcamp.configuration.overrides import key_of, parse_overrides
from hjcamp.errors import UsageError, shown


@dataclass(frozen=True)
class Interval:
    """Numbers from ``low`` to ``high``, both included: whole ones where both ends are, every ``step`` where one is given."""

    low: float
    high: float
    step: float | None = None
    log: bool = False


def asked_of(lines: Sequence[Override], settings: Mapping[str, Any]) -> dict[str, Override]:
    """Return the overrides by key: those of a call go before ``params`` in the sweeper's own settings."""
    own = parse_overrides([f"{key}={value}" for key, value in (settings.get("params") or {}).items()])
    return {key_of(line): line for line in (*own, *lines)}


def space_of(line: Override) -> Interval | list[str]:
    """Return what an override lets a sweeper choose, its values as Hydra writes them; a fixed one has one value.

    Raises ``UsageError`` for a range that holds no number.
    """
    value = line.value()
    if isinstance(value, IntervalSweep):
        found = _interval(line, value)
    elif isinstance(value, RangeSweep):
        found = _range(line, value)
    elif line.is_sweep_override():
        choices = list(dict.fromkeys(line.sweep_string_iterator()))
        return choices if choices else _refuse(line, "is an empty list")
    else:
        return [line.get_value_element_as_str()]
    return found


def ends_of(line: Override) -> tuple[str, str]:
    """Return an override with its first and with its last value."""
    space = space_of(line)
    ends = (space.low, space.high) if isinstance(space, Interval) else (space[0], space[-1])
    return (f"{line.get_key_element()}={ends[0]}", f"{line.get_key_element()}={ends[1]}")


def count_of(line: Override) -> int:
    """Return how many values an override goes through, 1 for a fixed one, without writing them out."""
    value = line.value()
    if isinstance(value, RangeSweep):
        return _count(*_numbers(line, value.start, value.stop, value.step))
    return len(value.list) if isinstance(value, ChoiceSweep) else 1


def _interval(line: Override, value: IntervalSweep) -> Interval:
    low, high = _numbers(line, value.start, value.end)
    if low >= high:
        _refuse(line, f"must rise, and {low:g} is not below {high:g}")
    if "log" in value.tags and low <= 0.0:
        _refuse(line, f"has logarithmic steps, which need ends above 0, and begins at {low:g}")
    return Interval(low, high, log="log" in value.tags)


def _range(line: Override, value: RangeSweep) -> Interval:
    start, stop, step = _numbers(line, value.start, value.stop, value.step)
    if "log" in value.tags:
        _refuse(line, "has steps of its own; logarithmic ones belong to tag(log, interval(a,b))")
    count = _count(start, stop, step)
    if count < 1:
        _refuse(line, f"holds no number: it goes from {start:g} to below {stop:g} in steps of {step:g}")
    last = start + (count - 1) * step
    return Interval(min(start, last), max(start, last), abs(step))


def _count(start: float, stop: float, step: float) -> int:
    # Hydra leaves its last number out, and adds as decimals
    return math.ceil((Decimal(stop) - Decimal(start)) / Decimal(step)) if step else 0


def _numbers(line: Override, *given: Any) -> list[float]:
    """Return the numbers as they were written, whole ones alone where all are."""
    if not all(isinstance(one, int | float) and not isinstance(one, bool) and math.isfinite(one) for one in given):
        _refuse(line, "needs finite numbers")
    return list(given) if all(isinstance(one, int) for one in given) else [float(one) for one in given]


def _refuse(line: Override, why: str) -> Any:
    raise UsageError(f"{shown(line.input_line)} {why}; write such as {line.key_or_group}=interval(0.5,1.5)")
