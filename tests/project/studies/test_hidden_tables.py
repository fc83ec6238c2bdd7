"""The benchmark of tables: its plan, its judgement, its page; the tables themselves need the truth plant's long simulation."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from truth.pump_joint.controller import Procedure, pid_step

from benchmarks.hidden_tables import running as hidden_tables
from benchmarks.hidden_tables.cases import BENCH, TRAJECTORIES, TableCase, conditions, plan, seen, text_of
from benchmarks.hidden_tables.page import outcome, page
from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.controllers.pid import LONGEST_DERIVATIVE, Pid
from hjcamp.plants.pump_joint.tables.question import asked
from hjcamp.trajectories import build_trajectory

TAG = "abc1234"


def line(kind: str, effect: str, verdict: str, *names: str) -> dict[str, Any]:
    """Return a line of the ledger."""
    case = TableCase(kind, effect, "strong" if effect else "", 1)
    return {
        "plan": hidden_tables.PLAN, "name": f"{case.name}-{verdict}-{'-'.join(names)}", "effort": "quick", "tag": TAG,
        "kind": kind, "effect": effect, "strength": case.strength, "right": case.verdict, "visible": 2.0, "seconds": 9.0,
        "verdict": verdict, "effects": list(names), "visibility": {},
    }  # fmt: skip


def test_the_plan_is_as_asked_on_rigs_of_their_own() -> None:
    cases = plan()
    kinds = [case.kind for case in cases]
    assert (kinds.count("effect"), kinds.count("outside")) == (12, 1) and kinds.count("null") == 8
    assert len({case.seed for case in cases}) == len(cases)
    shifted = plan(500)
    assert {case.seed for case in shifted}.isdisjoint({case.seed for case in cases})
    assert {"effect", "null"} <= set(kinds[:6])  # a part of them is a fair sample


def test_the_benches_motions_are_those_that_the_program_runs() -> None:
    """Written from the figures of 5.2.5, and the program's own: the same angle at each millisecond."""
    found = {name: one.reference() for name, preload, one in conditions() if preload == 0.35}
    assert set(found) == set(TRAJECTORIES)
    for name, reference in found.items():
        own = build_trajectory(Composer().compose([f"trajectory={name}"]).config["trajectory"])
        time = [0.001 * place for place in range(len(reference))]
        assert len(reference) == round(own.duration * 1000)
        assert reference * 0.0174532925 == pytest.approx(own.reference(time)[0], abs=1e-3)


def test_the_benches_controller_is_the_programs_as_the_table_says() -> None:
    """The truth plant's PID and the program's over one error that changes its direction twice, at rest in between."""
    time = np.arange(900) * 1e-3
    reference = np.sin(9.0 * time) * (time < 0.6)
    velocity = np.gradient(reference)
    error = 0.02 * np.cos(5.0 * time) + 0.01
    bumpless = float(BENCH["controller.bumpless"])
    values = {name: one.default for name, one in Pid.parameters.items()} | {"bumpless": bumpless}
    mine, truth = SimpleNamespace(direction=0.0, integral=0.0, errors=[0.0] * LONGEST_DERIVATIVE), np.zeros(7)
    truth[1], truth[2:] = 1.0, error[0]
    for index in range(len(time)):
        sample = SimpleNamespace(
            reference=error[index], velocity=velocity[index], arm=0.0, feedforward=0.0, period=1e-3, index=index
        )
        found = Pid.step(sample, SimpleNamespace(**values), mine)[0]
        assert pid_step.py_func(truth, error[index], velocity[index], Procedure()) == pytest.approx(found, rel=1e-9)


def test_a_table_is_one_that_the_program_reads(tmp_path: Path) -> None:
    table = [
        {**BENCH, "trajectory": name, "procedure.preload_mpa": preload, "tests": 5,
         "rmse1_deg": 1.5, "rmse1_deg_deviation": 0.1, "sse_deg": None, "sse_deg_deviation": None}
        for name, preload, _ in conditions()
    ]  # fmt: skip
    path = tmp_path / "table.csv"
    path.write_text(text_of(table), encoding="utf-8")
    question = asked([str(path)])
    assert len(question.cells) == len(question.conditions) == 14 and not question.lacking
    assert {one.config["procedure"]["preload_mpa"] for one in question.conditions} == {0.35, 0.5}


def test_how_far_a_table_has_moved() -> None:
    one = [{"rmse1_deg": 2.0, "rmse1_deg_deviation": 0.0, "sse_deg": None, "sse_deg_deviation": None}]
    one[0] |= {f"{name}_deg{more}": None for name in ("rmse2", "e_max") for more in ("", "_deviation")}
    assert seen([one[0] | {"rmse1_deg": 2.6}], one) == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (line("effect", "leakage", "effect", "leakage"), "right"),
        (line("effect", "payload_inertia", "effect", "line_inertance"), "right"),
        (line("effect", "leakage", "effect", "leakage", "pump_backlash"), "named with others"),
        (line("effect", "leakage", "effect", "encoder_lag"), "false name"),
        (line("effect", "leakage", "one_of", "encoder_lag", "leakage"), "right among several"),
        (line("effect", "leakage", "one_of", "encoder_lag", "tubing_creep"), "false name"),
        (line("effect", "leakage", "outside_library", "leakage"), "outside_library"),
        (line("null", "", "nothing_missing"), "right"),
        (line("null", "", "effect", "leakage"), "false name"),
        (line("outside", "stray_spring", "outside_library", "leakage"), "right"),
        (line("outside", "stray_spring", "one_of", "leakage", "encoder_lag"), "false name"),
        (line("null", "", "failed"), "failed"),
    ],
)
def test_answers_are_judged(answer: dict[str, Any], said: str) -> None:
    assert outcome(answer) == said


def test_the_page_says_how_many_were_run_and_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked_for: list[str] = []

    def answered(case: TableCase, effort: str, tag: str, workers: int) -> dict[str, Any]:
        asked_for.append(case.name)
        return {**line(case.kind, case.effect, case.verdict, *filter(None, [case.effect])), "name": case.name}

    monkeypatch.setattr(hidden_tables, "run_case", answered)
    options = ["--ledger", str(tmp_path / "l.jsonl"), "--page", str(tmp_path / "p.md"), "--tag", TAG]
    assert hidden_tables.main([*options, "--most", "2"]) == 0
    assert "2 of 21 cases. **19 of them have not been run yet.**" in (tmp_path / "p.md").read_text()
    assert hidden_tables.main(options) == 0
    assert asked_for == [case.name for case in plan()]
    text = (tmp_path / "p.md").read_text()
    assert "21 of 21 cases. Intervals" in text and "12 of 12 (76 - 100 %)" in text and "8 of 8 (68 - 100 %)" in text
    lines = [line("effect", "leakage", "effect", "leakage"), line("null", "", "effect", "leakage")]
    assert "1 of 1" in page(lines, 2, TAG, "x") and "false name" in page(lines, 2, TAG, "x")
