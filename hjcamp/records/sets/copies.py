"""Logs that are one test: readings of independent tests differ by the noise of their sensors at least."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hjcamp.records.log import TestLog
from hjcamp.records.noise import FEWEST
from hjcamp.records.sets.course import ROUNDING, Array, Course, by_condition, courses_of
from hjcamp.records.sets.glance import Glance
from hjcamp.records.sets.probe import Probed, probe_of


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
    """Return the logs that are copies of one of another condition, of those that may be; the two are read again.

    Simulations of two conditions may well be the same.
    """
    found: dict[int, Copy] = {}
    for log in logs:
        for may_be in log.may_be:
            pair = sorted((may_be, log.log), key=_age)
            if any(id(one) in found for one in pair):
                continue
            one, other = courses_of(pair)
            if (lag := _lag(one, other)) is not None and not (one.simulated and other.simulated):
                found[id(other.log)] = Copy(other.log, one.log, _text(one, other, lag))
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
    """Yield the pairs of one condition, the earlier first, then those of other conditions in which readings of one are in the other."""
    for group in by_condition(courses):
        for k, one in enumerate(group):
            yield from ((one, other) for other in group[k + 1 :])
    probed = [Probed.of(one) for one in courses]
    for k, one in enumerate(courses):
        for j in range(k + 1, len(courses)):
            if one.condition != courses[j].condition and (probed[k].may_be_in(courses[j]) or probed[j].may_be_in(one)):
                yield one, courses[j]


def _lag(one: Course, other: Course) -> int | None:
    """Return by how many samples ``other`` begins later in the readings that both share; None where they are two tests."""
    shared = [name for name in one.measured if name in other.measured]
    within = {name: max(one.rounding[name], other.rounding[name]) * (1.0 + ROUNDING) for name in shared}
    if not shared:
        return None
    probe = max(shared, key=lambda name: other.distinct[name])
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


def _changes(values: Array) -> int:
    return int(np.count_nonzero(np.diff(values)))


def _begins(one: Array, other: Array, within: float) -> list[int]:
    """Return the lags at which readings from the middle of ``other`` (n,) are found in ``one`` (m,), a few at most."""
    probe = probe_of(other)
    return [int(place) - int(probe.places[0]) for place in probe.found_in(one, within)[:FEWEST] if place != probe.places[0]]


def _text(one: Course, other: Course, lag: int) -> str:
    """Return in words that ``other`` is no test of its own."""
    if _simulated(one, other):
        return f"is {one.where} again: without scatter every repetition of a simulation is the same; they count once"
    cut = "" if lag == 0 and one.samples == other.samples else f", of which it has {other.samples} of {one.samples} samples"
    return f"is a copy of {one.where}{cut}: readings differ by less than their last digit; both count once"


def _simulated(one: Course, other: Course) -> bool:
    """Whether two courses are repetitions of a simulation, which differ by their seeds alone."""
    return one.simulated and other.simulated and one.log.metadata.get("seed") != other.log.metadata.get("seed")
