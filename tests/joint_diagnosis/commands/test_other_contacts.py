"""No answer hangs on the law of friction that the truth plant usually has: bristles, and a force smooth in speed."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from discrepancy_answers import Call, read_answer

sys.path.insert(0, str(Path(__file__).parents[2]))
from truth.pump_joint.case import write_case


@pytest.mark.study
@pytest.mark.parametrize(
    ("contact", "hidden", "verdict"),
    [
        ("bristles", [], "nothing_missing"),
        ("smooth", ["leakage"], "effect"),
    ],
)
def test_another_contact_gives_the_right_answer(
    call: Call, tmp_path: Path, contact: str, hidden: list[str], verdict: str
) -> None:
    write_case(tmp_path / "logs", hidden, "medium", 60010, contact=contact)
    answer = call("diagnose", tmp_path / "logs", "--effort", "quick", "--json", "d.json")
    assert answer.code == 0, answer.err
    found = read_answer(Path("d.json"))
    assert (found["verdict"], found["effects"]) == (verdict, hidden)
