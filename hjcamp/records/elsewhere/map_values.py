"""Values of the keys in a mapping file, each with its own refusal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.known_plants import DEFAULT
from hjcamp.model.declare.parameter import finite_number
from hjcamp.model.declare.plant import Plant
from hjcamp.records.of_plant import LONGEST_PERIOD_S

LOWEST_SAMPLING_HZ = 200.0  # of the usual plant: its logs have one sample each ms
HIGHEST_SAMPLING_HZ = 100e3
MOST_SKIPPED = 100_000
GAPS_HINT = "gaps: interpolate in the map draws lines between its neighbours"


def period_of_rows(content: Mapping[str, Any], plant: type[Plant], where: str) -> float | None:
    """Return the time between two rows, s, as ``period_s`` or ``sampling_hz`` say."""
    if "period_s" in content and "sampling_hz" in content:
        raise UsageError(f"{where}: give period_s or sampling_hz, not both")
    if content.get("period_s") is not None:
        period = number_of(content["period_s"], "period_s", where)
        if not 1.0 / HIGHEST_SAMPLING_HZ <= period <= LONGEST_PERIOD_S:
            allowed = f"allowed: {1.0 / HIGHEST_SAMPLING_HZ:g} to {LONGEST_PERIOD_S:g}"
            raise UsageError(f"{where}: period_s is {period:g}; {allowed}")
        rate = 1.0 / period
    elif content.get("sampling_hz") is not None:
        rate = number_of(content["sampling_hz"], "sampling_hz", where)
        if rate > HIGHEST_SAMPLING_HZ:
            raise UsageError(f"{where}: sampling_hz is {rate:g}; at most {HIGHEST_SAMPLING_HZ:g} Hz")
        if rate * LONGEST_PERIOD_S < 1.0:
            raise UsageError(f"{where}: sampling_hz is {rate:g}; at least {1.0 / LONGEST_PERIOD_S:.3g} Hz")
        period = 1.0 / rate
    else:
        return None
    if plant.name == DEFAULT and rate < LOWEST_SAMPLING_HZ * (1 - 1e-9):
        said = "sampling_hz is" if "sampling_hz" in content else "period_s is given for"
        raise UsageError(f"{where}: {said} {rate:g} Hz; below {LOWEST_SAMPLING_HZ:g} Hz too little is left of a test")
    return period


def only_known(content: Any, allowed: Sequence[str], kind: str, where: str) -> None:
    """Raise UsageError where a mapping holds another key than those ``allowed``."""
    if not isinstance(content, Mapping) or not content:
        raise UsageError(f"{where}: expected a mapping with the {kind}s {', '.join(allowed)}")
    for name in content:
        if name not in allowed:
            raise unknown(kind, str(name), allowed, where)


def number_of(value: Any, name: str, where: str) -> float:
    """Return a finite number; raises UsageError for anything else."""
    with suppress(ValueError):  # YAML 1.1 reads 1e-3 as a text
        value = float(value) if isinstance(value, str) else value
    number = finite_number(value)
    if number is None:
        raise UsageError(f"{where}: {name} is {shown(value)}, not a finite number")
    return number


def yes_or_no(value: Any, name: str, where: str) -> bool:
    """Return what is true or false; raises UsageError for anything else."""
    if not isinstance(value, bool):
        raise UsageError(f"{where}: {name} is {shown(value)}; true or false is needed")
    return value


def interpolates(content: Mapping[str, Any], key: str, words: Sequence[str], where: str) -> bool:
    """Return whether a key says the second of two words; raises UsageError for a third."""
    value = content.get(key, words[0])
    if value not in words:
        raise unknown("word", str(value), words, f"{key} of {where}")
    return bool(value == words[1])


def resample_of(value: Any, plant: type[Plant], where: str) -> float:
    """Return the period that uneven rows are brought to, s."""
    number = number_of(value, "resample_s", where)
    if not 1.0 / HIGHEST_SAMPLING_HZ <= number <= LONGEST_PERIOD_S:
        raise UsageError(f"{where}: resample_s is {number:g}; allowed: {1.0 / HIGHEST_SAMPLING_HZ:g} to {LONGEST_PERIOD_S:g}")
    if plant.name == DEFAULT:
        raise UsageError(f"{where}: resample_s: a log of plant {DEFAULT} has one sample each ms, its rows are brought to that")
    return number


def lines_of(value: Any, where: str) -> int:
    """Return how many lines stand before the header."""
    number = number_of(value, "skip_lines", where)
    if not 0 <= number <= MOST_SKIPPED or number != int(number):
        raise UsageError(f"{where}: skip_lines is {number:g}; a whole number from 0 to {MOST_SKIPPED} is needed")
    return int(number)


def separator_of(value: Any, where: str) -> str:
    """Return the one character between columns."""
    if not isinstance(value, str) or len(value.encode()) != 1:
        raise UsageError(f"{where}: separator is {shown(value)}; give one character, such as ',' or ';' or \"\\t\"")
    return value


def missing_of(value: Any, where: str) -> tuple[float | str, ...]:
    """Return the readings that stand for none, numbers or texts, as they are in the file."""
    listed = value if isinstance(value, list) else [value]
    if not listed or any(isinstance(one, bool | dict | list) or one is None for one in listed):
        raise UsageError(f'{where}: missing is {shown(value)}; give what stands for no reading, such as [-9999, "---"]')
    found: list[float | str] = []
    for one in listed:
        # YAML 1.1 reads 1e30 as a text; what a table holds as a text may be a number in another file
        with suppress(ValueError, OverflowError):
            found.append(float(one))
        found += [one] if isinstance(one, str) else []
    return tuple(found)
