"""Runs as rows: what is the same in all conditions of a run, and the mean of an indicator over them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from hjcamp.campaign.files.dotted_paths import look_up
from hjcamp.campaign.runs.finding import FoundRun
from hjcamp.errors import UsageError, unknown
from hjcamp.json_text import read_json
from hjcamp.report.runs.indicators import CHOICES, INDICATORS

USUAL = ("run", "campaign", "state", "tests", "started")
SESSION = ("git", "host", "version", "ended_at", "workers")
SEVERAL = "several"


def rows_of(runs: Sequence[FoundRun], columns: Sequence[str] = USUAL) -> list[dict[str, Any]]:
    """Return a row of ``columns`` for each run; raises ``UsageError`` for a column that no run has.

    A column is one of ``USUAL``, a group (``payload``), a parameter (``controller.positive.kp``), a key of the last session
    (``git``), or an indicator: its mean over the conditions, where the run has a report. What differs between conditions is
    "several".
    """
    rows = [{name: _value(run, name) for name in columns} for run in runs]
    known = (*USUAL, *CHOICES, *INDICATORS, *SESSION, "seed", "repetitions")
    for name in columns:
        if name not in known and rows and all(row[name] is None for row in rows):
            raise unknown("column", name, known, "--columns")
    return rows


def in_order(rows: list[dict[str, Any]], key: str) -> list[dict[str, Any]]:
    """Return the rows sorted by a column, ``-COLUMN`` from the largest; those without a value come last."""
    name = key.removeprefix("-")
    if rows and name not in rows[0]:
        raise UsageError(f"--sort {key}: no column of that name; columns: {', '.join(rows[0])}")
    there = [row for row in rows if row[name] is not None]
    as_text = any(isinstance(row[name], str) for row in there)
    there.sort(key=lambda row: str(row[name]) if as_text else row[name], reverse=key.startswith("-"))
    return [*there, *(row for row in rows if row[name] is None)]


def _value(run: FoundRun, name: str) -> Any:
    usual = {
        "run": str(run.path), "campaign": run.plan.campaign, "state": run.state, "started": run.started,
        "tests": f"{run.done}/{len(run.plan.tests)}", "seed": run.plan.seed, "repetitions": run.plan.repetitions,
    }  # fmt: skip
    if name in usual:
        return usual[name]
    if name in INDICATORS:
        return _indicator(run, name)
    session = (run.manifest["sessions"] or [{}])[-1]
    if name in session:
        return session[name]
    found = [one.choices.get(name, look_up(one.config, name)) for one in run.plan.conditions]
    first = found[0] if found else None
    if any(one != first for one in found):
        return SEVERAL
    return first if first is None or isinstance(first, str | int | float) else json.dumps(first, default=str)


def _indicator(run: FoundRun, name: str) -> float | None:
    try:
        metrics = read_json(run.path / "metrics.json")
        means = [float(one[name]["mean"]) for one in metrics.values() if name in one]
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None
    return sum(means) / len(means) if means else None
