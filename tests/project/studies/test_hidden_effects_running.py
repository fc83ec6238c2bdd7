"""The hidden-effect benchmark: its plan, its ledger, and how it goes on after an interruption."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_hidden_effects_benchmark import made_up
from truth.pump_joint.hidden import LIBRARY_NAMES

from benchmarks.hidden_effects import ledger as hidden_effects_ledger
from benchmarks.hidden_effects import running as hidden_effects
from benchmarks.hidden_effects.cases import HiddenCase, plan
from benchmarks.hidden_effects.ledger import Ledger, code_version
from benchmarks.hidden_effects.one_case import cleaned


def test_a_full_plan_has_new_rigs_alone_and_holds_the_small_one() -> None:
    full, small = plan("full"), plan("small")
    assert len(full) == 132 + 30 + 10 + 42 + 12
    assert min(case.seed for case in full) == 1000
    assert len({case.seed for case in plan("full", 200)}) == len(plan("full", 200))
    assert set(small) <= set(full) and full[: len(small)] == small
    assert len(small) == 59 and {case.effects[0] for case in small if case.kind == "single"} == set(LIBRARY_NAMES)


def test_a_plan_with_more_nulls_keeps_every_other_case() -> None:
    assert {case.name for case in plan("full")} <= {case.name for case in plan("full", 200)}
    assert {case.name for case in plan("small")} <= {case.name for case in plan("small", 40)}
    assert sum(case.kind == "null" for case in plan("small", 40)) == 40


def test_a_shifted_plan_is_the_same_on_other_rigs() -> None:
    plain, moved = plan("full"), plan("full", shift=5000)
    assert {(case.kind, case.effects, case.strength, case.seed + 5000) for case in plain} == {
        (case.kind, case.effects, case.strength, case.seed) for case in moved
    }
    assert not {case.name for case in plain} & {case.name for case in moved}
    assert all(case.name.endswith(f"-{case.seed}") for case in moved)


def test_a_part_of_the_plan_is_a_fair_sample_and_always_the_same() -> None:
    order = hidden_effects.shuffled(plan("full"))
    assert order == hidden_effects.shuffled(plan("full")) and sorted(order, key=str) == sorted(plan("full"), key=str)
    kinds = [case.kind for case in order[:60]]
    assert 25 <= kinds.count("single") <= 45 and 3 <= kinds.count("null") <= 14 and 4 <= kinds.count("outside") <= 18


def test_what_is_taken_out_goes_with_what_is_the_same_thing() -> None:
    taken = {case.effects[0]: case.without for case in plan("full") if case.kind == "taken_out"}
    assert taken["payload_inertia"] == ("line_inertance", "payload_inertia")
    assert taken["leakage"] == ("leakage",)


def test_a_ledger_survives_a_line_that_was_cut_short(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path / "results.jsonl")
    ledger.add(made_up("effect", ("leakage",), name="first"))
    with ledger.path.open("a") as stream:
        stream.write('{"plan": 1, "name": "tor')
    ledger.add(made_up("effect", ("leakage",), name="second", tag="other"))
    assert ledger.finished("made-up", "standard") == {"first"}
    assert ledger.finished("made-up", "quick") == set()
    assert set(ledger.visibilities()) == {"first", "second"}


def test_the_version_of_the_code_is_the_last_commit_that_changed_it(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[list[str]] = []

    def answered(command: list[str], **given: Any) -> Any:
        calls.append(command)
        return SimpleNamespace(returncode=0, stdout="1a2b3c4\n" if "log" in command else " M hjcamp/x.py\n")

    monkeypatch.setattr(hidden_effects_ledger.subprocess, "run", answered)
    assert code_version() == "1a2b3c4+changes"
    assert all(call[call.index("--") + 1 :] == ["hjcamp", "conf", "tests/truth"] for call in calls)


def test_a_line_of_the_ledger_has_plain_numbers_of_six_digits() -> None:
    assert cleaned({"a": [0.123456789, float("nan"), np.float64(3e9)], "b": (1, "x", True)}) == {
        "a": [0.123457, None, 3e9],
        "b": [1, "x", True],
    }


def test_only_what_is_left_is_run_and_the_page_is_kept_until_all_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cases = [HiddenCase(f"null-{seed}", "null", (), "", seed) for seed in (1, 2, 3)]
    asked: list[str] = []

    def stopped(left: list[HiddenCase], given: Any, seen: Any) -> Any:
        for case in left:
            if len(asked) == 2:
                asked.append("stop")
                raise KeyboardInterrupt
            asked.append(case.name)
            yield made_up("nothing_missing", (), (), "null", seed=case.seed, name=case.name)

    monkeypatch.setattr(hidden_effects, "plan", lambda *given: cases)
    monkeypatch.setattr(hidden_effects, "results", stopped)
    options = ["--ledger", str(tmp_path / "cases.jsonl"), "--tag", "made-up", "--page", str(tmp_path / "docs.md")]
    assert hidden_effects.main(options) == 130
    assert not (tmp_path / "docs.md").exists() and "Only 2 of 3" in (tmp_path / "cases.md").read_text()
    assert hidden_effects.main(options) == 0
    ran = [name for name in asked if name != "stop"]
    assert asked[2] == "stop" and sorted(ran) == ["null-1", "null-2", "null-3"]
    assert "planned cases are finished" not in (tmp_path / "docs.md").read_text()
    assert not list(tmp_path.glob("*.part")) and os.fspath(tmp_path) in capsys.readouterr().out
