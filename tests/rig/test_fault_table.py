"""Every fault and every stop once, at the start, in the middle or at the end of a test, against the committed table.

All rows, with every limit, are made by ``write_fault_table.py``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fault_cases import CASES, WHEN, Case
from fault_run import make_row

from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

TABLE = Path(__file__).parents[2] / "docs" / "rig_faults.md"
SELECTED = [case for case in CASES if not case.name.startswith("limit")]
ROWS = [(case, list(WHEN)[place % len(WHEN)]) for place, case in enumerate(SELECTED)]


@pytest.mark.parametrize(("case", "when"), ROWS, ids=[f"{case.name}, {when}".replace(" ", "_") for case, when in ROWS])
def test_row(
    case: Case, when: str, tmp_path: Path, composer: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = make_row(case, when, tmp_path, composer, monkeypatch)
    assert any(line.startswith(row.line()) for line in TABLE.read_text(encoding="utf-8").splitlines()), row


def test_the_table_is_whole() -> None:
    text = TABLE.read_text(encoding="utf-8")
    missing = [(case.name, when) for case in CASES for when in WHEN if f"| {case.name} | {when} |" not in text]
    assert not missing
