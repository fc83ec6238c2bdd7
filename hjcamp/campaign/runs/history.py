"""An indicator over the runs of a campaign, or over the commits that made them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hjcamp.campaign.runs.finding import FoundRun
from hjcamp.errors import UsageError, unknown
from hjcamp.json_text import read_json
from hjcamp.report.runs.indicators import INDICATORS
from hjcamp.report.tables.welch import SIGNIFICANT, Sample, holm, welch

OVER = ("commits", "runs")
COMMIT_DIGITS = 10


@dataclass(frozen=True)
class Moment:
    """One run of the history: its code, and the indicator by condition."""

    run: str
    started: str
    commit: str
    version: str
    samples: Mapping[str, Sample]


def read_words(words: Sequence[str]) -> tuple[list[str], str]:
    """Return the filters (KEY=VALUE) and the indicator of a call; raises ``UsageError`` for what is neither."""
    filters = [word for word in words if "=" in word]
    names = [word for word in words if "=" not in word] or [INDICATORS[0]]
    for name in names:
        if name not in INDICATORS:
            raise unknown("indicator", name, INDICATORS, "hjcamp history")
    if len(names) > 1:
        raise UsageError(f"one indicator at a time, not {', '.join(names)}")
    if not any(word.partition("=")[0] == "campaign" for word in filters):
        raise UsageError("a history is of one campaign: hjcamp history campaign=NAME [indicator]")
    return filters, names[0]


def moments_of(runs: Sequence[FoundRun], indicator: str, over: str) -> tuple[list[Moment], list[str]]:
    """Return the runs that have the indicator, oldest first, and the paths of those without a report.

    Over commits the newest run of each commit (with its changes) counts. Raises ``UsageError`` where there is none.
    """
    if over not in OVER:
        raise unknown("choice", over, OVER, "--over")
    found, without = [], []
    for run in sorted(runs, key=lambda one: (one.started, str(one.path))):
        samples = _samples(run, indicator)
        session = (run.manifest["sessions"] or [{}])[-1]
        changes = session.get("git_changes_sha256")
        commit = str(session.get("git") or "")[:COMMIT_DIGITS] + (f"+{changes[:4]}" if changes else "")
        if samples:
            found.append(Moment(str(run.path), run.started, commit, str(session.get("version", "")), samples))
        else:
            without.append(str(run.path))
    if over == "commits":
        newest = {(one.commit or one.version): one for one in found}
        found = [one for one in found if newest[one.commit or one.version] is one]
    if not found:
        raise UsageError(f"none of {len(runs)} runs has {indicator} in its metrics.json: hjcamp report RUN writes it")
    return found, without


def history_rows(moments: Sequence[Moment]) -> tuple[list[str], list[dict[str, Any]]]:
    """Return the conditions that all share, and a row for each moment.

    A row holds the ``mean`` over these conditions, its standard error, and ``changed``: the conditions whose mean differs
    from that of the row before (Welch, Holm). Raises ``UsageError`` where the moments share no condition.
    """
    shared = [name for name in moments[0].samples if all(name in one.samples for one in moments)]
    if not shared:
        first = next(one for one in moments if not set(one.samples) & set(moments[0].samples) or one is moments[-1])
        raise UsageError(f"{moments[0].run} and {first.run} have no condition in common; filter the runs with KEY=VALUE")
    rows: list[dict[str, Any]] = []
    for place, one in enumerate(moments):
        samples = [one.samples[name] for name in shared]
        variances = [sample.std**2 / sample.n if sample.std is not None else None for sample in samples]
        known = [value for value in variances if value is not None]
        changed = _changed(moments[place - 1], one, shared) if place else []
        rows.append(
            {
                "run": one.run,
                "started": one.started,
                "commit": one.commit,
                "version": one.version,
                "tests": sum(sample.n for sample in samples),
                "mean": sum(sample.mean for sample in samples) / len(samples),
                "standard_error": math.sqrt(sum(known)) / len(known) if len(known) == len(samples) else None,
                "changed": changed,
                "conditions": {
                    name: {"mean": sample.mean, "std": sample.std, "n": sample.n}
                    for name, sample in zip(shared, samples, strict=True)
                },
            }
        )
    return shared, rows


def _changed(before: Moment, after: Moment, names: Sequence[str]) -> list[dict[str, Any]]:
    corrected = holm([welch(after.samples[name], before.samples[name]) for name in names])
    return [
        {"condition": name, "difference": after.samples[name].mean - before.samples[name].mean, "p_holm": p}
        for name, p in zip(names, corrected, strict=True)
        if p is not None and p < SIGNIFICANT
    ]


def _samples(run: FoundRun, indicator: str) -> dict[str, Sample]:
    try:
        metrics = read_json(run.path / "metrics.json")
        return {
            str(name): Sample(float(one[indicator]["mean"]), _number(one[indicator]["std"]), int(one["n"]))
            for name, one in metrics.items()
            if indicator in one
        }
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}


def _number(value: Any) -> float | None:
    return None if value is None else float(value)
