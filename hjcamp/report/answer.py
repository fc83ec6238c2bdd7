"""What a report found, for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.report.build import Report
from hjcamp.report.check import Violation
from hjcamp.report.ci import metrics_of


def report_answer(made: Report, against: str | None, violations: Sequence[Violation] | None) -> dict[str, Any]:
    """Return what a report found, for programs: every condition, what stands next to it, and what is outside tolerances."""
    return {
        "schema": "hjcamp.report/1",
        "run": str(made.run_dir),
        "against": against,
        "page": str(made.page),
        "tables": sorted(made.tables),
        "tests": made.indicators.height,
        "conditions": metrics_of(made.by_condition),
        "comparison": made.comparison.to_dicts(),
        "configuration": _listed("difference", made.baseline.changes if made.baseline else {}),
        "not_compared": _listed("reason", made.differs),
        "effects": made.effects.to_dicts(),
        "verdict": made.verdict,
        "violations": None
        if violations is None
        else [{"condition": one.condition, "indicator": one.indicator, "message": str(one)} for one in violations],
    }


def _listed(word: str, found: Mapping[str, Sequence[str]]) -> list[dict[str, Any]]:
    return [{word: text, "conditions": list(names)} for text, names in found.items()]
