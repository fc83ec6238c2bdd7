"""Find logs in run folders and other folders, read them, and group the repetitions of one test."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.known_plants import DEFAULT, usual_plant
from hjcamp.records.check import RATE_TOLERANCE
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import PLANT_KEY, USUAL_PERIOD_S, plant_of, span
from hjcamp.records.read import read_log
from hjcamp.records.run_folder import planned_only
from hjcamp.storage import keep_within

SUFFIX = ".mcap"
# The plants that the analyses of tests can read.
ANALYSED: tuple[str, ...] = (DEFAULT,)
HARDWARE = usual_plant().rig


def find_logs(paths: Sequence[str | Path]) -> list[Path]:
    """Return the log files that ``paths`` stand for, sorted, each once.

    A path is a run folder (its ``logs/``), a folder of logs at any depth, or a log file. Raises UsageError for
    a path that is missing, a folder without logs, and no paths at all.
    """
    if not paths:
        raise UsageError("no logs were named: give a run folder, a folder of logs, or log files")
    found: dict[Path, Path] = {}
    for path in map(Path, paths):
        for log in _logs_at(path):
            found.setdefault(log.resolve(), log)
    return sorted(found.values())


def _logs_at(path: Path) -> list[Path]:
    try:
        if path.is_file():
            return [path]
        if not path.is_dir():
            raise UsageError(f"{path}: there is no such file or folder")
        keep_within(path)
        folder = path / "logs" if (path / "logs").is_dir() else path
        logs = [log for log in folder.rglob(f"*{SUFFIX}") if log.is_file()]
        if not logs:
            parts = len(list(folder.rglob(f"*{SUFFIX}.part")))
            unfinished = f"; {parts} unfinished ones (*.part) can be recovered: hjcamp log recover" if parts else ""
            raise UsageError(f"{folder}: there are no logs (*{SUFFIX}) in this folder{unfinished}")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    return logs


def tell(text: str) -> None:
    """Say something with the answer, on standard error."""
    print(f"hjcamp: {text}", file=sys.stderr)


def read_logs(paths: Sequence[str | Path], say: Callable[[str], None] = tell) -> list[TestLog]:
    """Return the test logs that ``paths`` stand for, in the order of ``find_logs``; raises as ``read_log`` does.

    In a run folder only the tests of its plan count; ``say`` hears of others. A log that is named itself always counts.
    Logs of several plants are refused.
    """
    return of_the_plan([read_log(path) for path in find_logs(paths)], paths, say)


def of_the_plan(logs: Sequence[TestLog], paths: Sequence[str | Path], say: Callable[[str], None]) -> list[TestLog]:
    """Return the logs of ``paths`` that count, as ``read_logs`` says."""
    named = {Path(path).resolve() for path in paths if Path(path).is_file()}
    searched = [log for log in logs if log.path is None or log.path.resolve() not in named]
    left_out = {id(log) for log in searched} - {id(log) for log in planned_only(searched, say)}
    logs = [log for log in logs if id(log) not in left_out]
    if not logs:
        raise UsageError(f"{', '.join(map(str, paths))}: no log is a test of the plan next to it")
    refuse_mixed_plants(logs)
    return logs


def group_by_condition(logs: Iterable[TestLog]) -> dict[str, list[TestLog]]:
    """Return the logs by condition: those in one list are repetitions of each other."""
    groups: dict[str, list[TestLog]] = {}
    for log in logs:
        groups.setdefault(log.condition_key, []).append(log)
    return groups


def refuse_mixed_plants(logs: Iterable[TestLog]) -> None:
    """Raise UsageError where logs are of different plants: no model and no table holds both."""
    first: TestLog | None = None
    for log in logs:
        first = first or log
        one, other = (each.metadata.get(PLANT_KEY) or DEFAULT for each in (first, log))
        if one != other:
            raise UsageError(
                f"logs of one plant given to another: {first.path} is of plant {one}, {log.path} of plant {other}; "
                "analyse the tests of each plant alone"
            )


def refuse_unanalysed(logs: Iterable[TestLog], what: str) -> None:
    """Raise UsageError for logs of a plant, or with a period, that the analysis ``what`` cannot read yet."""
    for log in logs:
        name = log.metadata.get(PLANT_KEY) or DEFAULT
        if name not in ANALYSED:
            raise UsageError(f"{log.path}: a log of plant {name}; {what} knows only {', '.join(ANALYSED)} so far")
        if abs(log.period / USUAL_PERIOD_S - 1) > RATE_TOLERANCE:
            given, known = span(log.period), span(USUAL_PERIOD_S)
            raise UsageError(f"{log.path}: one sample each {given}; {what} knows only one each {known} so far")


def refuse_mixed_hardware(logs: Iterable[TestLog]) -> None:
    """Raise UsageError where logs name different hardware of their plant: one model fits one rig."""
    first: dict[str, TestLog] = {}
    for log in logs:
        for name in plant_of(log.metadata, str(log.path)).rig:
            if name not in log.metadata:
                continue
            other = first.setdefault(name, log)
            if other.metadata[name] != log.metadata[name]:
                raise UsageError(
                    f"mixed hardware: {name} is '{other.metadata[name]}' in {other.path} and "
                    f"'{log.metadata[name]}' in {log.path}; analyse the tests of each rig alone"
                )
