"""The table of the study of hunts: what its ledger says, the last row of each case counting."""

from __future__ import annotations

from typing import Any

import pytest

from benchmarks.hunting.running import LEDGER, rows_of, table_of


def row(case: str, strategy: str, right: bool, seconds: float, false: bool = False) -> dict[str, Any]:
    return {"case": case, "strategy": strategy, "right": right, "false_name": false, "rig_s": seconds}


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([], ["| hunt | 0 | 0 | 0 | - |", "| random | 0 | 0 | 0 | - |", "| full | 0 | 0 | 0 | - |"]),
        (
            [
                row("a", "hunt", True, 30.0),
                row("a", "hunt", False, 20.0, True),
                row("a", "full", True, 80.0),
                row("b", "hunt", True, 60.0),
                row("b", "full", False, 80.0),
                row("c", "hunt", True, 10.0),
            ],
            ["| hunt | 3 | 2 | 1 | 0.50 (2 cases) |", "| random | 0 | 0 | 0 | - |", "| full | 2 | 1 | 0 | 1.00 (2 cases) |"],
        ),
    ],
)
def test_the_last_row_of_a_case_counts(rows: list[dict[str, Any]], expected: list[str]) -> None:
    assert table_of(rows).splitlines()[2:] == expected


def test_the_committed_ledger_is_read_whole() -> None:
    rows = rows_of(LEDGER)
    assert len(rows) == len(LEDGER.read_text(encoding="utf-8").splitlines())
    assert all({"case", "strategy", "right", "false_name", "rig_s", "verdict"} <= set(one) for one in rows)
