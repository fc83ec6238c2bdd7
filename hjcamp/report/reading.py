"""Read the logs of a run for its report: what counts, in the order of the plan, and what is named and left out."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from hjcamp.errors import UsageError
from hjcamp.records.log import observed
from hjcamp.report.against_run import Tests, read_tests
from hjcamp.report.pages.exploration import REFERENCE, Exploration, names_of
from hjcamp.report.runs.indicators import row_of
from hjcamp.report.runs.origin import RunOrigin
from hjcamp.report.runs.spread import Condition, Gathering
from hjcamp.report.runs.varied import frame_with_varied

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog
    from hjcamp.records.sets.look import InSet


AGAINST = ("published",)


@dataclass(frozen=True)
class LogsOfRun:
    """What the logs of a run hold: those that count, in the order of the plan, with notes on the others, kind and text."""

    logs: list[TestLog]
    indicators: pl.DataFrame
    spreads: list[Condition]
    shown: Exploration
    notes: list[tuple[str, str]]
    baseline: Tests | None


def read_logs(run_dir: Path, origin: RunOrigin, logs: Sequence[TestLog] | None, against: str | None) -> LogsOfRun:
    """Read the logs of a folder, or take those given, and a baseline's; copies and what cannot be used are named and left out."""
    from hjcamp.records.find import refuse_mixed_plants, tell
    from hjcamp.records.stored import stored_logs

    left_out: list[str] = []
    doubtful: list[str] = []

    def leave_out(text: str) -> None:
        left_out.append(text.replace(f"{run_dir}{os.sep}", ""))
        tell(text)

    found = list(logs) if logs is not None else stored_logs([run_dir], leave_out)
    if not found:
        raise UsageError(f"{run_dir}: there are no test logs to report on")
    refuse_mixed_plants(found)
    found = in_plan_order(found, origin)
    baseline = read_tests(Path(against)) if against is not None and against not in AGAINST else None
    indicators, spreads, in_sets, shown = _condensed(found, origin, run_dir)
    for one in in_sets:
        line = f"{one.log.path} {one.finding.text}"
        if counts_not(one):
            leave_out(line)
            found.remove(one.log)
        elif one.original is None:
            tell(line)
            doubtful.append(line.replace(f"{run_dir}{os.sep}", ""))
    notes = [*(("left out", text) for text in left_out), *(("doubtful", text) for text in doubtful)]
    return LogsOfRun(found, indicators, spreads, shown, notes, baseline)


def in_plan_order(logs: Sequence[TestLog], origin: RunOrigin) -> list[TestLog]:
    """Return the logs sorted by the conditions of the plan, then by repetition; others after them as they came."""
    place = {name: number for number, name in enumerate(origin.condition_order)}

    def key(log: TestLog) -> tuple[int, int]:
        repetition = log.metadata.get("repetition", "")
        return place.get(log.condition_key, len(place)), int(repetition) if repetition.isdecimal() else 0

    return sorted(logs, key=key) if place else list(logs)


def _condensed(
    logs: Sequence[TestLog], origin: RunOrigin, folder: Path
) -> tuple[pl.DataFrame, list[Condition], list[InSet], Exploration]:
    """Return the indicators of all logs, the spread of each condition, what the logs say as a set, and what the explorer shows.

    Copies are left out. The logs of one condition are read once and let go, all once more without those that are copies of a log of
    another condition.
    """
    from hjcamp.records.sets.glance import Glance, glance_at
    from hjcamp.records.sets.look import look_across, look_at_condition
    from hjcamp.records.stored import kept

    shown = Exploration(len(logs), [REFERENCE], observed=observed(logs))
    names = names_of(logs)
    groups: dict[str, list[int]] = {}
    for place, log in enumerate(logs):
        groups.setdefault(log.condition_key, []).append(place)
    rows: dict[int, dict[str, Any]] = {}
    spreads = []
    in_sets: list[InSet] = []
    glances: list[Glance] = []
    for name, places in groups.items():
        gathering, group, before = Gathering(name), [logs[place] for place in places], tuple(glances)
        with kept(group):
            found = look_at_condition(group)
            for place in (place for place in places if not any(one.log is logs[place] and counts_not(one) for one in found)):
                glances.append(glance_at(logs[place], before))
                rows[place] = row_of(logs[place], folder)
                gathering.add(logs[place])
                shown.add_log(names[place], logs[place])
        in_sets += found
        spreads.append(gathering.condition())
    across = look_across(glances)
    if again := [one for one in across if counts_not(one)]:
        rest = [log for log in logs if not any(one.log is log for one in again)]
        indicators, conditions, others, explored = _condensed(rest, origin, folder)
        return indicators, conditions, [*again, *others], explored
    attached = [logs[place].attachments.get("config.yaml", b"") for place in sorted(rows)]
    return (
        frame_with_varied([rows[place] for place in sorted(rows)], attached, origin.axes),
        spreads,
        [*in_sets, *across],
        shown,
    )


def counts_not(one: InSet) -> bool:
    """Whether a log is a copy of another one; repetitions of a simulation without scatter keep their rows."""
    return one.original is not None and not one.simulated
