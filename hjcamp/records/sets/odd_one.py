"""The log that differs from its repetitions by more than they do from each other, and what would make it agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from hjcamp.errors import counted
from hjcamp.records.log import TestLog
from hjcamp.records.sets.course import Array, Course, by_condition
from hjcamp.records.sets.mistakes import Mistake, mistakes, of_another_condition

# By chance one set of logs in twenty has a log that is named.
LEVEL = 0.05
# Of what a column does (rms): logs that differ by less are repetitions, and commands one command.
MATTERS = 0.1


@dataclass(frozen=True)
class Odd:
    """A log that is none of the repetitions it is taken for; ``explained`` where one mistake of a logger makes it one."""

    log: TestLog
    field: str
    text: str
    explained: bool


@dataclass(frozen=True)
class Apart:
    """How far a column is from its repetitions: the ``ratio`` to what these differ by, what chance allows of it, and whether it is far.

    For a single repetition what they differ by is not ``known``, and any difference that matters is far.
    """

    ratio: float
    allowed: float
    far: bool
    known: bool


def odd_ones(courses: Sequence[Course]) -> list[Odd]:
    r"""Return the logs that differ from all their repetitions by more than these do from each other.

    For the deviation :math:`d_i` of log i from the mean of the n - 1 others, column by column,

    .. math:: F = \frac{n - 1}{n} \frac{\overline{d_i^2}}{s_{-i}^2}

    with the variance s² of the others, is beyond what chance exceeds in one of twenty sets of logs (Bonferroni over logs and columns).
    Degrees of freedom are those of the deviations' spectra, :math:`(\sum P)^2 / \sum P^2` (Satterthwaite 1946,
    doi:10.2307/3002019). What was commanded otherwise is another test, unless one mistake explains it. Of two repetitions one is
    named only where a mistake, undone, makes them agree by as much more than chance.
    """
    groups = [group for group in by_condition(courses) if len(group) > 1]
    level = LEVEL / max(sum(len(group) * len(group[0].columns) for group in groups), 1)
    found: list[Odd] = []
    for group in groups:
        others = [one for one in groups if one is not group]
        for k, one in enumerate(group):
            odd = _odd(one, [*group[:k], *group[k + 1 :]], others, level)
            # of two repetitions each differs as much from the other
            if odd is not None and (len(group) > 2 or not any(each.log is group[0].log for each in found)):
                found.append(odd)
    return found


def _odd(one: Course, rest: Sequence[Course], others: Sequence[Sequence[Course]], level: float) -> Odd | None:
    names = [name for name in (*one.measured, *one.commanded) if all(name in each.columns for each in rest)]
    look = partial(_apart, rest=rest, level=level)
    before = {name: look(name, one.columns) for name in names}
    far = [name for name in names if before[name].far]
    if not far:
        return None
    worst = max(far, key=lambda name: before[name].ratio)
    moved = _commanded_otherwise(one, rest)
    for group in others if len(rest) > 1 else ():
        shared = [name for name in names if all(name in each.columns for each in group)]
        if len(group) > 1 and shared and not any(_apart(name, one.columns, group, level).far for name in shared):
            return Odd(
                one.log, worst, f"{_differs(one, rest, worst)}, and {of_another_condition(group[0].condition)}", True
            )
    for mistake in mistakes(one, rest, far):
        after = {name: look(name, mistake.columns) for name in names}
        if all(_mended(before[name], after[name]) for name in far) and not any(
            after[name].far for name in names if name not in far
        ):
            return _explained(one, rest, others, worst, mistake)
    if moved or not before[worst].known:
        return None
    times = float(np.sqrt(before[worst].ratio))
    text = f"{_differs(one, rest, worst)} by {times:.3g} times what these differ by; find out why, or leave it out"
    return Odd(one.log, worst, text, False)


def _explained(
    one: Course, rest: Sequence[Course], others: Sequence[Sequence[Course]], worst: str, mistake: Mistake
) -> Odd:
    """Return the finding of a log that agrees after a mistake is undone: of two, that which goes against the other conditions."""
    agrees = f"and agrees with {'them' if len(rest) > 1 else 'it'} {mistake.text}"
    if len(rest) > 1:
        return Odd(one.log, worst, f"{_differs(one, rest, worst)}, {agrees}", not mistake.fitted)
    along = [other for group in others for other in group]
    first, second = (_goes_along(each, along, mistake.fields) for each in (one, rest[0]))
    if first == second:
        return Odd(
            one.log,
            worst,
            f"{_differs(one, rest, worst)}, {agrees}; which of the two is wrong is not known",
            not mistake.fitted,
        )
    wrong, right = (one, rest[0]) if first < second else (rest[0], one)
    return Odd(wrong.log, worst, f"{_differs(wrong, [right], worst)}, {agrees}", not mistake.fitted)


def _differs(one: Course, rest: Sequence[Course], worst: str) -> str:
    whom = f"its {counted(len(rest), 'repetition')}" if len(rest) > 1 else f"its repetition {rest[0].where}"
    return f"'{worst}' differs from {'all ' if len(rest) > 1 else ''}{whom}"


def _mended(before: Apart, after: Apart) -> bool:
    return not after.far if before.known else after.ratio * before.allowed < before.ratio


def _apart(name: str, columns: dict[str, Array], rest: Sequence[Course], level: float) -> Apart:
    from scipy.special import fdtri

    length = min(len(columns[name]), *(one.samples for one in rest))
    own, each = columns[name][:length], np.array([one.columns[name][:length] for one in rest])
    apart = own - each.mean(axis=0)
    size = len(rest) / (len(rest) + 1) * float(np.mean(apart**2))
    scatter, freedom = _scatter(rest, name)
    known, least = freedom > 0.0, max(one.smallest[name] for one in rest) ** 2 + 1e-300
    # without any scatter to hold it against it is held against itself, after a mistake is undone
    ratio = size / max(scatter, least)
    allowed = float(fdtri(_freedom(apart), freedom if known else _freedom(apart), 1.0 - level))
    matters = size > MATTERS**2 * float(np.var(each))
    if len(rest) > 1:
        between = np.max(np.mean((each[:, None] - each[None, :]) ** 2, axis=2))
        matters &= bool(np.min(np.mean((own - each) ** 2, axis=1)) > between)
    return Apart(ratio, allowed, matters and (not known or ratio > allowed), known)


def _scatter(group: Sequence[Course], name: str) -> tuple[float, float]:
    """Return the mean square by which repetitions differ, and its degrees of freedom; 0 and 0 for a single one."""
    if len(group) < 2:
        return 0.0, 0.0
    length = min(one.samples for one in group)
    each = np.array([one.columns[name][:length] for one in group])
    freedom = float(np.mean([_freedom(one) for one in each - each.mean(axis=0)]))
    return float(np.mean(np.var(each, axis=0, ddof=1))), (len(group) - 1) * freedom


def _freedom(deviation: Array) -> float:
    """Return the degrees of freedom of a deviation (n,): those of white noise are half its samples, those of an offset one."""
    power = np.abs(np.fft.fft(deviation)) ** 2
    squares = float(np.sum(power**2))
    return float(np.sum(power)) ** 2 / squares if squares > 0.0 else 1.0


def _commanded_otherwise(one: Course, rest: Sequence[Course]) -> bool:
    """Whether a log was given another command than its repetitions."""
    for name in one.commanded:
        for other in rest:
            if name in other.columns:
                length = min(one.samples, other.samples)
                a, b = one.columns[name][:length], other.columns[name][:length]
                if np.mean((a - b) ** 2) > MATTERS**2 * max(np.var(a), np.var(b)):
                    return True
    return False


def _goes_along(one: Course, along: Sequence[Course], fields: Sequence[str]) -> float:
    """Return how far the correlations of ``fields`` with other columns are those of other logs; 0 without any."""
    total = 0.0
    for field in fields:
        for name in one.columns:
            if name in fields:
                continue
            usual = [
                _correlation(other.columns[field], other.columns[name])
                for other in along
                if {field, name} <= other.columns.keys()
            ]
            total += float(np.sum(usual)) * _correlation(one.columns[field], one.columns[name])
    return total


def _correlation(one: Array, other: Array) -> float:
    a, b = one - one.mean(), other - other.mean()
    size = float(np.sqrt(np.sum(a**2) * np.sum(b**2)))
    return float(np.sum(a * b)) / size if size > 0.0 else 0.0
