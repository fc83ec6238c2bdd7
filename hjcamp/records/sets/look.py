"""What a set of logs says as a set, each finding in one sentence, the same for every command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hjcamp.errors import UsageError, counted
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.plausible import Finding
from hjcamp.records.sets.copies import copies
from hjcamp.records.sets.course import Course, courses_of, input_fields
from hjcamp.records.sets.odd_one import odd_ones


@dataclass(frozen=True)
class InSet:
    """What is wrong with a log among others: ``odd`` where it differs from its repetitions, so that nothing can be concluded with it,
    and the ``original`` that it is a copy of, where it is no test of its own, or is ``simulated`` again without any scatter.
    """

    log: TestLog
    finding: Finding
    odd: bool = False
    original: TestLog | None = None
    simulated: bool = False

    @property
    def line(self) -> str:
        """The finding in one line, behind the log's file."""
        return f"{self.log.path}: {self.finding.line}"


def look_at(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what logs say as a set, what must be refused first; logs of several plants or periods are several sets."""
    sets: dict[tuple[str, float], list[TestLog]] = {}
    for log in logs:
        sets.setdefault((plant_of(log.metadata, str(log.path)).name, log.period), []).append(log)
    found = [one for each in sets.values() if len(each) > 1 for one in _of_one_plant(each)]
    return sorted(found, key=lambda one: not one.finding.refused)


def _of_one_plant(logs: Sequence[TestLog]) -> list[InSet]:
    courses = courses_of(logs)
    same = copies(courses)
    left_out = {id(one.log) for one in same}
    own: list[Course] = [one for one in courses if id(one.log) not in left_out]
    found = [InSet(one.log, Finding(one.field, one.text, one.explained), odd=True) for one in odd_ones(own)]
    found += [InSet(one.log, Finding("", one.text, False), original=one.original, simulated=one.simulated) for one in same]
    return [*found, *_lacking(logs)]


def _lacking(logs: Sequence[TestLog]) -> list[InSet]:
    """Say which channels and inputs some of the logs have and others lack, and what is taken in their place."""
    plant = plant_of(logs[0].metadata, str(logs[0].path))
    inputs = {field: plant.inputs[name] for name, field in input_fields(plant).items()}
    measured = [one.field for one in plant.channels] or list(plant.measured)
    found = []
    for field in (*measured, *inputs):
        lacking = [log for log in logs if field not in log.columns]
        if not lacking or len(lacking) == len(logs):
            continue
        if field in inputs:
            instead = f"taken as {inputs[field].default:g} SI there"
        else:
            instead = "computed from the command there" if plant.channels else "left out of all"
        there = counted(len(logs) - len(lacking), "log")
        more = f", and so in {counted(len(lacking) - 1, 'more log')}" if len(lacking) > 1 else ""
        text = f"'{field}' is missing here{more}, while {there} of the set have it; it is {instead}"
        found.append(InSet(lacking[0], Finding(field, text, False)))
    return found


def refuse_odd(logs: Sequence[TestLog]) -> list[InSet]:
    """Return what logs say as a set; raises UsageError, one line, where a log is wrong and it is known how."""
    found = look_at(logs)
    if found and found[0].finding.refused:
        more = sum(one.finding.refused for one in found) - 1
        rest = f" (and {counted(more, 'more log')})" if more else ""
        raise UsageError(f"{found[0].log.path}: {found[0].finding.text}; mend it, or leave it out{rest}")
    return found
