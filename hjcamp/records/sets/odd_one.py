"""The log that differs from its repetitions by more than they do from each other, and what would make it agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hjcamp.errors import counted
from hjcamp.records.log import TestLog
from hjcamp.records.sets.apart import LEAST, LEVEL, Apart, apart, commanded_otherwise, stands_out
from hjcamp.records.sets.course import Array, Course, by_condition
from hjcamp.records.sets.mistakes import Mistake, mistakes


@dataclass(frozen=True)
class Odd:
    """A log that is none of the repetitions it is taken for; ``explained`` where one mistake of a logger makes it one."""

    log: TestLog
    field: str
    text: str
    explained: bool


def odd_ones(courses: Sequence[Course]) -> list[Odd]:
    """Return the logs that differ from all their repetitions by more than these do from each other (see `apart`).

    That is so where it stands out of the other logs of the set (`stands_out`), at a level of one in twenty sets of logs (Bonferroni
    over logs, columns, and three looks at each). A log that was commanded otherwise is another test. One mistake without a free
    number explains a log where it, undone, brings a column as much nearer as chance does to one pair in twenty that does not repeat
    at all, and leaves none far: then also one of two repetitions is named, and one that was commanded otherwise.
    """
    groups = [group for group in by_condition(courses) if len(group) > 1]
    level = LEVEL / max(sum(3 * len(group) * len(group[0].columns) for group in groups), 1)
    seen = {one: _look(one, [other for other in group if other is not one], level) for group in groups for one in group}
    found: list[Odd] = []
    for group in groups:
        others = [one for one in groups if one is not group]
        for one in group:
            odd = _odd(one, [other for other in group if other is not one], others, seen, level)
            if odd is not None:
                found.append(odd)
                if len(group) == 2:  # each differs as much from the other
                    break
    return found


def _look(one: Course, rest: Sequence[Course], level: float) -> dict[str, Apart]:
    """Return how far each column that its repetitions have as well is from these."""
    return {name: apart(name, one.columns, rest, level) for name in one.columns if all(name in each.columns for each in rest)}


def _odd(
    one: Course,
    rest: Sequence[Course],
    others: Sequence[Sequence[Course]],
    seen: dict[Course, dict[str, Apart]],
    level: float,
) -> Odd | None:
    before = seen[one]
    outside = [name for name, own in before.items() if own.outside]
    if not outside:
        return _twice(one, rest, list(before), level)
    usual = {name: _usual(name, one, [other for group in others for other in group], seen) for name in before}

    def far(name: str, seen: Apart) -> bool:
        return seen.far or (seen.outside and seen.known and stands_out(seen, usual[name], level))

    worst = max(outside, key=lambda name: (far(name, before[name]), before[name].ratio))
    stands = [name for name in outside if stands_out(before[name], usual[name], level)]
    for group in others if stands else ():
        shared = [name for name in before if all(name in each.columns for each in group)]
        other_test = len(group) < 2 or not shared or commanded_otherwise(one, group)
        if not other_test and not any(apart(name, one.columns, group, level).far for name in shared):
            other = f"and agrees with the tests of condition '{group[0].condition}': its condition is wrong"
            return Odd(one.log, worst, f"{_differs(one, rest, worst)}, {other}", True)
    explained: dict[bool, tuple[float, float, str, Mistake]] = {}
    for mistake in mistakes(one, rest, outside):
        field = worst if worst in mistake.fields else mistake.fields[0]
        first = apart(field, mistake.columns, rest, level, mistake.skipped)
        best = explained.get(mistake.fitted, (math.inf,))[0]
        if not first.ratio * first.turned < before[field].ratio or first.whole > before[field].whole:
            continue
        after = {name: apart(name, mistake.columns, rest, level, mistake.skipped) for name in before}
        worse = (
            far(name, each) or (each.outside and not each.known and not before[name].outside) for name, each in after.items()
        )
        if first.ratio < best and not any(worse):
            explained[mistake.fitted] = first.ratio, first.turned, field, mistake
    plain, fitted = explained.get(False), explained.get(True)
    if plain and not (fitted and fitted[0] * fitted[1] < plain[0]):
        return _explained(one, rest, others, *plain[2:])
    if fitted and fitted[2] in stands:
        return _explained(one, rest, others, *fitted[2:])
    if not stands or (commanded_otherwise(one, rest) and any(name in one.measured for name in stands)):
        return None
    worst = max(stands, key=lambda name: before[name].ratio)
    times = float(np.sqrt(before[worst].ratio))
    text = f"{_differs(one, rest, worst)} by {times:.3g} times what these differ by; find out why, or leave it out"
    return Odd(one.log, worst, text, False)


def _usual(name: str, one: Course, elsewhere: Sequence[Course], seen: dict[Course, dict[str, Apart]]) -> list[Apart]:
    """Return how far a column of other logs is from its repetitions: of other conditions alone, where it has no scatter there."""
    away = [seen[other][name] for other in elsewhere if name in seen[other] and seen[other][name].known]
    if away and all(each.ratio <= LEAST for each in away):
        return away
    return [own[name] for other, own in seen.items() if other is not one and name in own and own[name].known]


def _twice(one: Course, rest: Sequence[Course], names: Sequence[str], level: float) -> Odd | None:
    """Return the finding of a log in which the test of its repetitions comes again after it."""
    length = max(each.samples for each in rest)
    if len(rest) < 2 or one.samples < 2 * length:
        return None
    again: dict[str, Array] = {name: values[length:] for name, values in one.columns.items()}
    if any(apart(name, again, rest, level).far for name in names):
        return None
    return Odd(one.log, names[0], f"holds the test of its {counted(len(rest), 'repetition')} twice, one after the other", True)


def _explained(one: Course, rest: Sequence[Course], others: Sequence[Sequence[Course]], worst: str, mistake: Mistake) -> Odd:
    """Return the finding of a log that agrees after a mistake is undone: of two, that which goes against the other conditions."""
    agrees = f"and agrees with {'them' if len(rest) > 1 else 'it'} {mistake.text}"
    known = not mistake.fitted
    if len(rest) > 1:
        return Odd(one.log, worst, f"{_differs(one, rest, worst)}, {agrees}", known)
    along = [other for group in others for other in group]
    first, second = (_goes_along(each, along, mistake.fields) for each in (one, rest[0]))
    wrong, right = (one, rest[0]) if first <= second else (rest[0], one)
    which = "; which of the two is wrong is not known" if first == second else ""
    return Odd(wrong.log, worst, f"{_differs(wrong, [right], worst)}, {agrees}{which}", known)


def _differs(one: Course, rest: Sequence[Course], worst: str) -> str:
    whom = f"all its {counted(len(rest), 'repetition')}" if len(rest) > 1 else f"its repetition {rest[0].where}"
    return f"'{worst}' differs from {whom}"


def _goes_along(one: Course, along: Sequence[Course], fields: Sequence[str]) -> float:
    """Return how far the correlations of ``fields`` with other columns are those of other logs; 0 without any."""
    total = 0.0
    for field in fields:
        for name in one.columns.keys() - set(fields):
            both = [other.columns for other in along if {field, name} <= other.columns.keys()]
            usual = sum(_correlation(other[field], other[name]) for other in both)
            total += usual * _correlation(one.columns[field], one.columns[name])
    return total


def _correlation(one: Array, other: Array) -> float:
    a, b = one - one.mean(), other - other.mean()
    size = float(np.sqrt(np.sum(a**2) * np.sum(b**2)))
    return float(np.sum(a * b)) / size if size > 0.0 else 0.0
