"""The study of any plant: what an answer counts as, that it goes on where it stopped, and its page."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from benchmarks.any_plant import running as any_plant
from benchmarks.any_plant.judging import good, outcome, page

TRUTH = {"verdict": "effect", "effects": ["sensor_lag"], "alike": ["command_delay"]}


@pytest.mark.parametrize(
    ("verdict", "effects", "expected"),
    [
        ("effect", ["sensor_lag"], "right"),
        ("effect", ["command_delay"], "alike"),
        ("effect", ["spring"], "false"),
        ("effect", ["sensor_lag", "spring"], "false"),
        ("one_of", ["sensor_lag", "spring"], "honest"),
        ("one_of", ["spring", "dead_band"], "false"),
        ("outside_library", [], "outside"),
        ("nothing_missing", [], "nothing"),
        ("cannot_tell", [], "cannot_tell"),
        ("failed", [], "failed"),
    ],
)
def test_what_an_answer_counts_as(verdict: str, effects: list[str], expected: str) -> None:
    assert outcome(TRUTH, verdict, effects) == expected
    assert good({"truth": TRUTH, "outcome": expected}) == (expected in ("right", "honest"))


def test_the_study_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []

    def program(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
        calls.append(arguments[0])
        assert not (folder / "truth.json").exists()
        assert (folder / "plants" / "tanks.py").exists() and (folder / "import.yaml").exists()
        if arguments[0] == "diagnose":
            said = {"verdict": "effect", "effects": ["leakage_at_lower"], "drivers": []}
            (folder / "answer.json").write_text(json.dumps(said))
        return subprocess.CompletedProcess([], 0, "", "")

    monkeypatch.setattr(any_plant, "hjcamp", program)
    monkeypatch.setattr(any_plant, "code_version", lambda: "made-up")
    ledger, out = tmp_path / "ledger.jsonl", tmp_path / "page.md"
    fixed = ["--plants", "tanks", "--count", "1", "--ledger", str(ledger), "--page", str(out)]
    assert any_plant.main([*fixed, "--limit", "1"]) == 0
    assert any_plant.main([*fixed, "--limit", "1"]) == 0
    lines = [json.loads(line) for line in ledger.read_text().splitlines()]
    wanted = list(any_plant.cases(["tanks"], 1, 700_000))
    assert [x["name"] for x in lines] == [case.name for case in wanted[:2]]
    assert len({case.name for case in wanted}) == len(any_plant.MACHINES["tanks"][1]) + any_plant.NULLS
    assert calls == ["import", "diagnose"] * 2
    text = out.read_text()
    assert f"| tanks | {lines[1]['truth']['effect']} | {lines[1]['truth']['form']} |" in text and "2 cases" in text


def test_the_page_counts_by_plant_and_shows_what_was_false() -> None:
    truth = TRUTH | {"plant": "axis", "effect": "sensor_lag", "form": "late", "form_in_library": False, "one_log": True}
    lines = [
        {"name": f"a{k}", "truth": truth, "outcome": how, "effects": ["spring"], "message": "no"}
        for k, how in enumerate(["right", "honest", "false", "failed"])
    ]
    text = page(lines, "made-up", "command")
    assert "| axis | one | other form | 2 of 4 (15 - 85 %) | 1 of 4 (5 - 70 %)" in text
    assert "| a2 | - | spring |" in text and "| a3 | no |" in text
