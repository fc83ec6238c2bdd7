"""The log that differs from its repetitions by more than they do from each other, and what would make it agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hjcamp.errors import counted
from hjcamp.records.log import TestLog
from hjcamp.records.sets.apart import (
    LEAST,
    LEVEL,
    REFUSED,
    Apart,
    Hunting,
    apart,
    commanded_otherwise,
    hunting,
    in_closed_loop,
    stands_out,
)
from hjcamp.records.sets.course import Array, Course, by_condition
from hjcamp.records.sets.mistakes import Mistake, mistakes

# Two tests that do not repeat at all come so near by chance: what says how a log differs, not whether.
LEVEL_OF_CHANGE = 0.05


@dataclass(frozen=True)
class Odd:
    """A log that is none of the repetitions it is taken for; ``explained`` where one mistake of a logger makes it one."""

    log: TestLog
    field: str
    text: str
    explained: bool


@dataclass(frozen=True, eq=False)
class _Log:
    """One log among its repetitions ``rest`` and ``others`` conditions: how far each column is, and what is usual for it.

    ``loops`` is None where its condition is in open loop. ``level`` is that of one column and look, ``logs`` their number in the set.
    """

    one: Course
    rest: Sequence[Course]
    others: Sequence[Sequence[Course]]
    loops: Hunting | None
    level: float
    logs: int

    @cached_property
    def before(self) -> dict[str, Apart]:
        """How far each column that its repetitions have as well is from these."""
        shared = [name for name in self.one.columns if all(name in each.columns for each in self.rest)]
        return {name: apart(name, self.one.columns, self.rest, self.level, loops=self.loops) for name in shared}

    def after(self, mistake: Mistake, name: str) -> Apart:
        """Return how far a column is once a mistake is undone."""
        return apart(name, mistake.columns, self.rest, self.level, mistake.skipped, self.loops)

    def usual(self, name: str, logs: Sequence[_Log]) -> list[Apart]:
        """Return how far a column of other logs is from its repetitions: of other conditions, where it has no scatter there.

        What is usual in closed loop, those in closed loop say alone.
        """
        same = [each for each in logs if each is not self and (each.loops is not None or self.loops is None)]
        known = [(each, each.before[name]) for each in same if name in each.before and each.before[name].known]
        away = [own for each, own in known if each.one.condition != self.one.condition]
        return away if away and all(own.ratio <= LEAST for own in away) else [own for _, own in known]

    def stands(self, own: Apart, usual: Sequence[Apart]) -> bool:
        """Whether a column is farther from its repetitions than chance allows: in closed loop by both statistics."""
        return own.outside and stands_out(own, usual, self.level) and (self.loops is None or own.far)

    def far(self, own: Apart, usual: Sequence[Apart]) -> bool:
        """Whether a column does not agree, by either statistic; of a single repetition nothing is known."""
        return own.far if self.loops else own.far or (own.outside and own.known and stands_out(own, usual, self.level))


def odd_ones(courses: Sequence[Course]) -> list[Odd]:
    """Return the logs that differ from all their repetitions by more than these do from each other (see `apart`).

    That is so where it stands out of the other logs of the set (`stands_out`), at a level of one in a hundred sets of logs
    (Bonferroni over logs, columns, and three looks at each). One mistake without a free number explains a log where it, undone,
    brings a column as much nearer as chance does to one pair in twenty that does not repeat at all, and leaves none far: then also
    one of two repetitions is named, and one that was commanded otherwise. What is compelling is refused (`_compelling`).
    """
    groups = [group for group in by_condition(courses) if len(group) > 1]
    level = LEVEL / max(sum(3 * len(group) * len(group[0].columns) for group in groups), 1)
    closed = [group for group in groups if in_closed_loop(group)]
    logs = []
    for group in groups:
        others = [each for each in groups if each is not group]
        loops = hunting([each for each in closed if each is not group])
        for one in group:
            rest = [other for other in group if other is not one]
            own = loops if in_closed_loop(rest) else None
            logs.append(_Log(one, rest, others, own, level, sum(map(len, groups))))
    found: list[Odd] = []
    pairs: set[str] = set()
    for log in logs:
        odd = None if log.one.condition in pairs else _odd(log, logs)
        if odd is not None:
            found.append(odd)
            if len(log.rest) == 1:  # each differs as much from the other
                pairs.add(log.one.condition)
    return found


def _odd(log: _Log, logs: Sequence[_Log]) -> Odd | None:
    one, rest, before = log.one, log.rest, log.before
    outside = [name for name, own in before.items() if own.outside]
    if not outside:
        return _twice(one, rest, list(before), log.level)
    usual = {name: log.usual(name, logs) for name in before}
    worst = max(outside, key=lambda name: (log.far(before[name], usual[name]), before[name].ratio))
    stands = [name for name in outside if log.stands(before[name], usual[name])]
    if stands and (condition := _other_condition(log)):
        other = f"and agrees with the tests of condition '{condition}': its condition is wrong"
        return Odd(one.log, worst, f"{_differs(one, rest, worst)}, {other}", True)
    plain, fitted = _explaining(log, outside, usual)
    if plain and not (fitted and fitted[0][0] * _turned(log, fitted[0][1]) < plain[0][0]):
        field, mistake = plain[0][1:]
        fits = [one for _, name, one in plain if _compelling(log, name, one)]
        unique = bool(fits) and fits[0] is mistake and all(_same(mistake, one) for one in fits)
        beyond = field in stands
        if beyond or _as_near(log, field, mistake, LEVEL):
            return _explained(one, rest, log.others, field, mistake, unique and (beyond or len(rest) == 1))
    if fitted and fitted[0][1] in stands:
        return _explained(one, rest, log.others, *fitted[0][1:], False)
    if not stands or (commanded_otherwise(one, rest) and any(name in one.measured for name in stands)):
        return None
    worst = max(stands, key=lambda name: before[name].ratio)
    times = float(np.sqrt(before[worst].ratio))
    text = f"{_differs(one, rest, worst)} by {times:.3g} times what these differ by; find out why, or leave it out"
    return Odd(one.log, worst, text, False)


def _other_condition(log: _Log) -> str | None:
    """Return the one condition with which a log agrees that was commanded otherwise than its repetitions.

    Where any condition is in closed loop, what drives a plant is no command of the test: there a reference says it, or nothing.
    """
    shown = any(name.startswith("reference_") for name in log.one.commanded)
    fed_back = log.loops is not None or any(map(in_closed_loop, log.others))
    if (fed_back and not shown) or not commanded_otherwise(log.one, log.rest):
        return None
    agrees = []
    for group in log.others:
        shared = [name for name in log.before if all(name in each.columns for each in group)]
        if shared and not commanded_otherwise(log.one, group):
            loops = log.loops or (hunting([group]) if in_closed_loop(group) else None)
            if not any(apart(name, log.one.columns, group, log.level, loops=loops).far for name in shared):
                agrees.append(group[0].condition)
    return agrees[0] if len(agrees) == 1 else None


def _explaining(
    log: _Log, outside: Sequence[str], usual: dict[str, list[Apart]]
) -> tuple[list[tuple[float, str, Mistake]], list[tuple[float, str, Mistake]]]:
    """Return the mistakes that, undone, leave nothing far, the best first: those without a free number, and fitted ones."""
    worst = max(outside, key=lambda name: (log.far(log.before[name], usual[name]), log.before[name].ratio))
    found: dict[bool, list[tuple[float, str, Mistake]]] = {False: [], True: []}
    for mistake in mistakes(log.one, log.rest, outside):
        field = worst if worst in mistake.fields else mistake.fields[0]
        first, own = log.after(mistake, field), log.before[field]
        by_chance = first.turned(LEVEL_OF_CHANGE, first.least_freedom)
        if not first.ratio * by_chance < own.ratio or first.whole > own.whole:
            continue
        after = {name: log.after(mistake, name) for name in log.before}
        worse = (
            log.far(each, usual[name]) or (each.outside and not each.known and not log.before[name].outside)
            for name, each in after.items()
        )
        if not any(worse):
            found[mistake.fitted].append((first.ratio, field, mistake))
    return sorted(found[False], key=lambda one: one[0]), sorted(found[True], key=lambda one: one[0])


def _turned(log: _Log, field: str) -> float:
    own = log.before[field]
    return own.turned(LEVEL_OF_CHANGE, own.least_freedom)


def _as_near(log: _Log, field: str, mistake: Mistake, level: float) -> bool:
    """Whether a column is so near once a mistake is undone as by chance a test that does not repeat at all is in few sets of logs."""
    own = log.before[field]
    return log.after(mistake, field).ratio * own.turned(level / log.logs, own.freedom) < own.ratio


def _compelling(log: _Log, field: str, mistake: Mistake) -> bool:
    """Whether a log, as recorded, is impossible as a repetition, and is one with a mistake undone, by chance in one of 1000 sets.

    Every column that the mistake touches is off by more than all it does, and is as near as the others then.
    """
    undone = {name: log.after(mistake, name) for name in mistake.fields}
    return _as_near(log, field, mistake, REFUSED) and all(
        log.before[name].gross and not (own.outside and own.known) for name, own in undone.items()
    )


def _same(one: Mistake, other: Mistake) -> bool:
    """Whether two mistakes are one in other words: mm read as m, or m as km."""
    return all(np.allclose(values, other.columns[name], rtol=1e-9, atol=0.0) for name, values in one.columns.items())


def _twice(one: Course, rest: Sequence[Course], names: Sequence[str], level: float) -> Odd | None:
    """Return the finding of a log in which the test of its repetitions comes again after it."""
    length = max(each.samples for each in rest)
    if len(rest) < 2 or one.samples < 2 * length:
        return None
    again: dict[str, Array] = {name: values[length:] for name, values in one.columns.items()}
    if any(apart(name, again, rest, level).far for name in names):
        return None
    return Odd(one.log, names[0], f"holds the test of its {counted(len(rest), 'repetition')} twice, one after the other", True)


def _explained(
    one: Course,
    rest: Sequence[Course],
    others: Sequence[Sequence[Course]],
    worst: str,
    mistake: Mistake,
    known: bool,
) -> Odd:
    """Return the finding of a log that agrees after a mistake is undone: of two, that which goes against the other conditions."""
    agrees = f"and agrees with {'them' if len(rest) > 1 else 'it'} {mistake.text}"
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
