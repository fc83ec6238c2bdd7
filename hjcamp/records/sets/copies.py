"""Logs that are one test: readings of independent tests differ by the noise of their sensors at least."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.log import TestLog
from hjcamp.records.noise import FEWEST, step_of
from hjcamp.records.sets.course import ROUNDING, Array, Course, by_condition, courses_of
from hjcamp.records.sets.glance import Glance, Sizes, size_of

# Readings in which a copy that begins elsewhere is looked for.
PROBES = 16
# Two courses of different conditions are looked at where mean and spread of each column agree within this part of its spread.
CLOSE = 0.02


@dataclass(frozen=True)
class Copy:
    """A log that is no test of its own, and the ``original`` that counts for it; ``simulated`` with another seed, without scatter."""

    log: TestLog
    original: TestLog
    text: str
    simulated: bool = False


def counted_once(logs: Sequence[TestLog]) -> tuple[list[TestLog], list[Copy]]:
    """Return the logs without those that are copies of an earlier one, and these."""
    found = copies(courses_of(logs))
    left_out = {id(one.log) for one in found}
    return [log for log in logs if id(log) not in left_out], found


def copies(courses: Sequence[Course]) -> list[Copy]:
    """Return the courses that are copies of an original: every reading equal within half its last digit, for most of the shorter.

    So are readings that differ by less than a millionth of what they do, and a copy that lacks rows at an end. The original is the
    older file, else that of the shorter name, else that of the name first in the alphabet.
    """
    found: dict[int, Copy] = {}
    for one, other in _pairs(sorted(courses, key=lambda one: _age(one.log))):
        if id(one.log) in found or id(other.log) in found:
            continue
        lag = _lag(one, other)
        if lag is not None:
            found[id(other.log)] = Copy(other.log, one.log, _text(one, other, lag), _simulated(one, other))
    return list(found.values())


def copies_across(logs: Sequence[Glance]) -> list[Copy]:
    """Return the logs that are copies of one of another condition; only those that look the same are read again.

    Simulations of two conditions may well be the same.
    """
    found: dict[int, Copy] = {}
    in_order = sorted(logs, key=lambda one: _age(one.log))
    for k, first in enumerate(in_order):
        for second in in_order[k + 1 :]:
            if id(first.log) in found or id(second.log) in found or first.log.condition_key == second.log.condition_key:
                continue
            if _look_the_same(first.sizes, second.sizes):
                one, other = courses_of([first.log, second.log])
                if (lag := _lag(one, other)) is not None and not (one.simulated and other.simulated):
                    found[id(second.log)] = Copy(second.log, first.log, _text(one, other, lag))
    return list(found.values())


def _age(log: TestLog) -> tuple[float, int, str]:
    """Return what sorts originals first; several repetitions of a simulation, or logs without a file, by their names alone."""
    path = log.path
    try:
        written = path.stat().st_mtime if path is not None else 0.0
    except OSError:
        written = 0.0
    name = path.name if path is not None else log.condition_key
    return written, len(name), name


def _pairs(courses: Sequence[Course]) -> Iterator[tuple[Course, Course]]:
    """Yield the pairs of one condition, the earlier first, then those of other conditions that look the same as a whole."""
    for group in by_condition(courses):
        for k, one in enumerate(group):
            yield from ((one, other) for other in group[k + 1 :])
    rest = list(courses)
    sizes = [{name: size_of(one.columns[name]) for name in one.measured} for one in rest]
    for k, one in enumerate(rest):
        for j in range(k + 1, len(rest)):
            if one.condition != rest[j].condition and _look_the_same(sizes[k], sizes[j]):
                yield one, rest[j]


def _look_the_same(one: Sizes, other: Sizes) -> bool:
    shared = one.keys() & other.keys()
    return bool(shared) and all(
        max(abs(one[name][0] - other[name][0]), abs(one[name][1] - other[name][1])) <= CLOSE * max(one[name][1], other[name][1])
        for name in shared
    )


def _lag(one: Course, other: Course) -> int | None:
    """Return by how many samples ``other`` begins later in the readings that both share; None where they are two tests."""
    shared = [name for name in one.measured if name in other.measured]
    within = {name: _rounding(one.columns[name], other.columns[name]) for name in shared}
    if not shared:
        return None
    probe = max(shared, key=lambda name: len(np.unique(other.columns[name])))
    for lag in (0, *_begins(one.columns[probe], other.columns[probe], within[probe])):
        first, last = max(lag, 0), min(one.samples, other.samples + lag)
        if 2 * (last - first) < min(one.samples, other.samples):
            continue
        pairs = [
            (one.columns[name][first:last], other.columns[name][first - lag : last - lag], within[name]) for name in shared
        ]
        if all(np.max(np.abs(a - b)) <= rounding for a, b, rounding in pairs) and any(
            _changes(a) >= FEWEST for a, _, _ in pairs
        ):
            return lag
    return None


def _rounding(one: Array, other: Array) -> float:
    """Return by how much two columns may differ that are printed from one: half the coarser last digit."""
    half = 0.5 * max(step_of(one), step_of(other))
    return max(half, ROUNDING * float(np.std(one))) * (1.0 + ROUNDING)


def _changes(values: Array) -> int:
    return int(np.count_nonzero(np.diff(values)))


def _begins(one: Array, other: Array, within: float) -> list[int]:
    """Return the lags at which readings from the middle of ``other`` (n,) are found in ``one`` (m,), a few at most."""
    places = np.arange(len(one))
    found: NDArray[np.intp] = places
    middle = len(other) // 2
    probes = np.unique(np.linspace(max(middle - len(other) // 8, 0), middle, PROBES).astype(int))
    for at in probes:
        moved = found + (at - int(probes[0]))
        found = found[(moved < len(one))]
        found = found[np.abs(one[found + (at - int(probes[0]))] - other[at]) <= within]
    return [int(place) - int(probes[0]) for place in found[:FEWEST] if place != probes[0]]


def _text(one: Course, other: Course, lag: int) -> str:
    """Return in words that ``other`` is no test of its own."""
    if _simulated(one, other):
        return f"is {one.where} again: without scatter every repetition of a simulation is the same; they count once"
    cut = "" if lag == 0 and one.samples == other.samples else f", of which it has {other.samples} of {one.samples} samples"
    return f"is a copy of {one.where}{cut}: readings differ by less than their last digit; both count once"


def _simulated(one: Course, other: Course) -> bool:
    """Whether two courses are repetitions of a simulation, which differ by their seeds alone."""
    return one.simulated and other.simulated and one.log.metadata.get("seed") != other.log.metadata.get("seed")
