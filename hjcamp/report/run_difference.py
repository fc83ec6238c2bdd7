"""Two runs side by side: where they come from, what is set differently, and how the means differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.report.against_run import RunComparison, read_tests
from hjcamp.report.runs.settings import ABSENT, equal_leaves, unequal

SCHEMA = "hjcamp.run_difference/1"
#: What the logs say of where they come from.
ORIGIN = ("campaign", "plant", "backend", "rig", "model", "version", "git")


def run_difference(one: Path, other: Path) -> dict[str, Any]:
    """Return the answer of ``hjcamp diff``; ``origin`` and ``configuration`` hold only what differs.

    Conditions of equal names are compared, or the only one of each; `UsageError` where a path has no logs.
    """
    found = RunComparison(read_tests(one), read_tests(other))
    ours, theirs = found.run.conditions, found.baseline.conditions
    facts = {name: [_values(tests.metadata, name) for tests in (found.run, found.baseline)] for name in ORIGIN}
    return {
        "schema": SCHEMA,
        "runs": [str(one), str(other)],
        "pairs": [{"conditions": list(pair)} for pair in found.pairs.items()],
        "alone": [
            [name for name in ours if name not in found.pairs],
            [name for name in theirs if name not in found.pairs.values()],
        ],
        "origin": [{"name": name, "values": values} for name, values in facts.items() if values[0] != values[1]],
        "configuration": configuration_rows(found),
        "results": found.cells.drop("table").to_dicts(),
        "verdict": found.verdict if found.pairs else "",
    }


def configuration_rows(found: RunComparison) -> list[dict[str, Any]]:
    """Return each parameter that differs in a pair: its values (None and ``absent_in`` where it is not there), the conditions."""
    rows: dict[tuple[str, str, str], dict[str, Any]] = {}
    sides = (found.run.configurations, found.baseline.configurations)
    pairs: list[tuple[str, Mapping[str, Any], Mapping[str, Any]]] = [
        (name, sides[0].get(name, {}), sides[1].get(other, {})) for name, other in found.pairs.items()
    ]
    if not pairs:
        # without a pair, what all tests of one run have is held against what all tests of the other have
        shared = [dict(equal_leaves(list(side.values()))) for side in sides]
        known = [{key: one[key] for key in one if key in other} for one, other in zip(shared, shared[::-1], strict=True)]
        pairs = [(name, known[0], known[1]) for name in found.run.conditions]
    for name, ours, theirs in pairs:
        for key, *values in unequal(ours, theirs):
            row = rows.setdefault(
                (key, repr(values[0]), repr(values[1])),
                {
                    "parameter": key,
                    "values": [None if value is ABSENT else value for value in values],
                    "absent_in": [place for place, value in enumerate(values) if value is ABSENT],
                    "conditions": [],
                },
            )
            row["conditions"].append(name)
    return list(rows.values())


def _values(metadata: Sequence[dict[str, str]], name: str) -> list[str]:
    return sorted({one[name] for one in metadata if name in one})
