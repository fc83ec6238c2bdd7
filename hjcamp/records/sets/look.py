"""What a set of logs says as a set, each finding in one sentence, the same for every command."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from hjcamp.errors import UsageError, counted
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.plausible import Finding
from hjcamp.records.sets.copies import Copy, copies, copies_across
from hjcamp.records.sets.course import Course, courses_of
from hjcamp.records.sets.glance import Glance, glance_at
from hjcamp.records.sets.incomplete import incomplete
from hjcamp.records.sets.odd_one import odd_ones
from hjcamp.records.sets.sizes import unlike_sizes
from hjcamp.records.stored import ROOM_BYTES, kept

Each = TypeVar("Each")


@dataclass(frozen=True)
class InSet:
    """What is wrong with a log among others: ``odd`` where it differs from its repetitions, so that nothing can be concluded with it,
    and the ``original`` that it is a copy of, where it is no test of its own, or is ``simulated`` again without any scatter. One
    in which a field of the others is ``missing`` is ``left_out`` of an analysis where that counts.
    """

    log: TestLog
    finding: Finding
    odd: bool = False
    original: TestLog | None = None
    simulated: bool = False
    missing: bool = False
    left_out: bool = False

    @property
    def line(self) -> str:
        """The finding in one line, behind the log's file."""
        return f"{self.log.path}: {self.finding.line}"


def look_at(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what logs say as a set, what must be refused first; logs of several plants or periods are several sets."""
    found = [
        one
        for each in _sets(logs, lambda log: log)
        for one in (*_of_tests(each), *_of_glances([glance_at(log) for log in each]))
    ]
    return sorted(found, key=lambda one: not one.finding.refused)


def look_at_condition(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what the logs of one condition say among themselves, as `look_at`; what they lack the whole set says."""
    found = [one for each in _sets(logs, lambda log: log) for one in _of_tests(each)]
    return sorted(found, key=lambda one: not one.finding.refused)


def look_one_by_one(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what stored logs say as a set, with few of them in memory: repetitions of a condition in batches that fit there."""
    found: list[InSet] = []
    glances: list[Glance] = []
    for batch in _batches(logs):
        before = tuple(glances)
        with kept(batch):
            found += look_at_condition(batch)
            glances += [glance_at(log, before) for log in batch]
    return sorted([*found, *look_across(glances)], key=lambda one: not one.finding.refused)


def _batches(logs: Sequence[TestLog]) -> Iterator[list[TestLog]]:
    """Yield the logs of each condition, in several parts where their files are larger than the room for stored ones."""
    conditions: dict[str, list[TestLog]] = {}
    for log in logs:
        conditions.setdefault(log.condition_key, []).append(log)
    for group in conditions.values():
        batch: list[TestLog] = []
        room = ROOM_BYTES
        for log in group:
            size = log.path.stat().st_size if log.path else 0
            if batch and size > room:
                yield batch
                batch, room = [], ROOM_BYTES
            batch.append(log)
            room -= size
        yield batch


def look_across(logs: Sequence[Glance]) -> list[InSet]:
    """Return what logs, of which a glance was kept, say across their conditions: copies, and what some of them lack."""
    sets = _sets(logs, lambda one: one.log)
    return [one for each in sets for one in (*map(_copy, copies_across(each)), *_of_glances(each))]


def lines_of(found: Iterable[InSet]) -> list[str]:
    """Return the findings in lines; what several logs lack is said of the first."""
    first: dict[object, InSet] = {}
    for one in found:
        first.setdefault(one.finding.text if one.missing else id(one), one)
    return [one.line for one in first.values()]


def _sets(logs: Sequence[Each], log_of: Callable[[Each], TestLog]) -> list[list[Each]]:
    """Return logs of one plant and period, several of them, in one list."""
    sets: dict[tuple[str, float], list[Each]] = {}
    for one in logs:
        log = log_of(one)
        sets.setdefault((plant_of(log.metadata, str(log.path)).name, log.period), []).append(one)
    return [each for each in sets.values() if len(each) > 1]


def _of_tests(logs: Sequence[TestLog]) -> list[InSet]:
    courses = courses_of(logs)
    same = copies(courses)
    left_out = {id(one.log) for one in same}
    own: list[Course] = [one for one in courses if id(one.log) not in left_out]
    found = [InSet(one.log, Finding(one.field, one.text, one.explained, kind="differs"), odd=True) for one in odd_ones(own)]
    return [*found, *map(_copy, same)]


def _copy(one: Copy) -> InSet:
    return InSet(one.log, Finding("", one.text, False, kind="copy"), original=one.original, simulated=one.simulated)


def _of_glances(logs: Sequence[Glance]) -> list[InSet]:
    lacking = [
        InSet(one.log, Finding(one.field, one.text, False, kind="field missing"), missing=True, left_out=one.left_out)
        for one in incomplete(logs)
    ]
    return [*(InSet(log, finding) for log, finding in unlike_sizes(logs)), *lacking]


def refuse_odd(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what logs say as a set; raises UsageError, one line, where a log is wrong and it is known how."""
    found = look_at(logs)
    if found and found[0].finding.refused:
        more = sum(one.finding.refused for one in found) - 1
        rest = f" (and {counted(more, 'more log')})" if more else ""
        raise UsageError(f"{found[0].log.path}: {found[0].finding.text}; mend it, or leave it out{rest}")
    return found
