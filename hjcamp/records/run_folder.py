"""Which logs in a run folder are the tests of its plan; others are never averaged in."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.plan import NAME, SHOWN_DIGITS, Plan, PlannedTest, read_plan
from hjcamp.storage import keep_within


def difference(plan: Plan, test: PlannedTest, metadata: Mapping[str, str]) -> str | None:
    """Return what tells a log from the test that was planned; None where it is that test."""
    planned = {
        "condition": test.condition,
        "repetition": str(test.repetition),
        "seed": str(test.seed),
        "config_sha256": plan.condition(test.condition).sha256,
    }
    differences = [
        f"{key} {_short(metadata.get(key, 'missing'))}, planned {_short(value)}"
        for key, value in planned.items()
        if metadata.get(key) != value
    ]
    return "; ".join(differences) or None


def run_of(log: Path) -> Path | None:
    """Return the run folder in whose ``logs/`` a log lies; None where it lies in none."""
    for folder in log.absolute().parents:
        if folder.name == "logs" and (folder.parent / NAME).exists():
            return folder.parent
    return None


def planned_only(logs: Sequence[TestLog], say: Callable[[str], None]) -> list[TestLog]:
    """Return the logs that lie in no run folder or are a test of its plan, each test once; ``say`` hears of the others.

    Raises ``UsageError`` where a ``plan.json`` cannot be read or was changed.
    """
    runs: dict[Path, list[TestLog]] = {}
    for log in logs:
        run = run_of(log.path) if log.path is not None else None
        if run is not None:
            runs.setdefault(run, []).append(log)
    left_out = {id(log) for run, members in runs.items() for log in _strangers(run, members, say)}
    return [log for log in logs if id(log) not in left_out]


def _strangers(run: Path, logs: Sequence[TestLog], say: Callable[[str], None]) -> list[TestLog]:
    plan = read_plan(run / NAME)
    by_path = {(run / test.log).absolute(): test for test in plan.tests}
    by_name = {(test.condition, str(test.repetition)): test for test in plan.tests}
    found: set[str] = set()
    strangers = []
    # A log in its own place comes before a second one of its test, such as one that was recovered.
    for log in sorted(logs, key=lambda log: log.path is None or log.path.absolute() not in by_path):
        assert log.path is not None
        named = (log.metadata.get("condition", ""), log.metadata.get("repetition", ""))
        test = by_path.get(log.path.absolute()) or by_name.get(named)
        reason = "no test of the plan" if test is None else difference(plan, test, log.metadata)
        if reason is None and test is not None and test.id in found:
            reason = f"a second log of {test.id}"
        if reason is not None:
            say(f"{log.path} is left out: {reason} ({run / NAME})")
            strangers.append(log)
        elif test is not None:
            found.add(test.id)
    return strangers


def refuse_links_out(folder: Path) -> None:
    """Raise ``UsageError`` for a link in a run folder that leads out of it: what is written there would land elsewhere."""
    keep_within(folder)
    root = folder.resolve()
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = os.path.join(place, name)
            target = Path(os.path.realpath(path))  # takes a link to itself, too
            if os.path.islink(path) and not target.is_relative_to(root):
                raise UsageError(
                    f"{path} is a link that leads out of the run folder, to {target}; a run writes into its own folder only"
                )


def _short(value: str) -> str:
    return value[:SHOWN_DIGITS] if len(value) == 64 else value
