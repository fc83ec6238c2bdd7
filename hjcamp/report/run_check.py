"""Whether a run gives what a baseline gave, course by course, for any plant: the check of a model in a job."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.stored import kept, stored_logs
from hjcamp.report.ci import clean


@dataclass(frozen=True)
class Difference:
    """How far the mean course of a ``field`` is from the baseline's: ``rms``, and the ``share`` of the ``range`` that it had there.

    ``fault``: why it cannot be compared; the share is infinite then.
    """

    condition: str
    field: str
    rms: float
    range: float
    share: float
    fault: str = ""

    def within(self, tolerance: float) -> bool:
        """Whether it may be that far off."""
        return self.share <= tolerance

    @property
    def text(self) -> str:
        """The difference in words."""
        return self.fault or f"differs by {self.rms:.3g} rms, {self.share:.2%} of the {self.range:.3g} that it covers"


def differences(run: Path, baseline: Path) -> Iterator[Difference]:
    """Yield the difference of each measured or given course of each condition of the baseline.

    Raises UsageError where there are no logs.
    """
    ours, theirs = (_conditions(path) for path in (run, baseline))
    for condition, logs in theirs.items():
        if condition not in ours:
            yield Difference(condition, "", math.nan, math.nan, math.inf, "is not in the run")
            continue
        with kept(logs), kept(ours[condition]):
            before, now = _mean(logs), _mean(ours[condition])
        for field, values in before.items():
            if field in ("time_s", "phase"):
                continue
            yield _of(condition, field, values, now.get(field))
    for condition in ours:
        if condition not in theirs:
            yield Difference(condition, "", math.nan, math.nan, math.inf, "is not in the baseline")


def _conditions(path: Path) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {}
    for log in stored_logs([path]):
        found.setdefault(log.condition_key, []).append(log)
    if not found:
        raise UsageError(f"{path}: there are no logs")
    return found


def _mean(logs: Sequence[Any]) -> dict[str, np.ndarray]:
    """Return the mean over repetitions of each column that all have, as long as the shortest."""
    names = [name for name in logs[0].columns if all(name in log.columns for log in logs)]
    rows = min(log.samples for log in logs)
    return {name: np.mean([log.columns[name][:rows] for log in logs], axis=0) for name in names}


def _of(condition: str, field: str, before: np.ndarray, now: np.ndarray | None) -> Difference:
    if now is None:
        return Difference(condition, field, math.nan, math.nan, math.inf, "is not logged any more")
    covers = float(np.ptp(before))
    if len(before) != len(now):
        return Difference(condition, field, math.nan, covers, math.inf, f"has {len(now)} samples, {len(before)} before")
    rms = float(np.sqrt(np.mean((now - before) ** 2)))
    return Difference(condition, field, rms, covers, rms / covers if covers else math.inf if rms else 0.0)


def junit(found: Sequence[Difference], tolerance: float) -> str:
    """Return JUnit's XML: a case for each course."""
    failed = [one for one in found if not one.within(tolerance)]
    root = ElementTree.Element("testsuites")
    counts = {"tests": str(len(found)), "failures": str(len(failed)), "errors": "0", "skipped": "0"}
    suite = ElementTree.SubElement(root, "testsuite", {"name": "hjcamp check", **counts})
    for one in found:
        case = ElementTree.SubElement(
            suite, "testcase", classname=clean(one.condition), name=clean(one.field or one.condition), time="0"
        )
        if one in failed:
            ElementTree.SubElement(case, "failure", message=clean(one.text)).text = clean(one.text)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
