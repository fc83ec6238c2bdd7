"""A sweep whose jobs give a number: its plan, its best job, and a sweeper that looks for the best gain."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import hjcamp.backends
from hjcamp.commands.campaigns import run
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from conftest import Call

SMALL = (
    "campaign=robustness_vertical",
    "trajectory=sine_0p5hz",
    "conditions=sine_0p5hz__pid",
    "repetitions=2",
    "workers=1",
)
KP = "controller.positive.kp"
BEST = 0.9


@pytest.fixture
def tuned(call: Call, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Call the program on a backend whose error is smallest, 1 deg, at a gain of 0.9."""

    def run_test(config: dict, seed: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
        kp = config["controller"]["positive"]["kp"]
        time = np.arange(400) * 1e-3
        error = np.full(400, 1.0 + 10.0 * (kp - BEST) ** 2)
        line = np.full(400, 0.3)
        columns = {"time_s": time, "phase": np.full(400, 3.0), "reference_deg": 60 * time, "arm_deg": 60 * time - error}
        return columns | {"pressure1_mpa": line, "pressure2_mpa": line, "pump_deg": 510 * time}, {}

    monkeypatch.setattr(hjcamp.backends, "run_test", run_test)
    return call


def test_a_sweep_with_an_objective_names_its_best_job(tuned: Call, tmp_path: Path) -> None:
    code, out, err = tuned("run", "-m", *SMALL, f"{KP}=0.7,0.9,1.2", "objective=rmse1_deg + 0*e_max_deg", "run_dir=s")
    assert (code, err) == (0, ""), err
    with (tmp_path / "s" / "sweep.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row[KP] for row in rows] == ["0.7", "0.9", "1.2"]
    assert [float(row["rmse1_deg + 0*e_max_deg"]) for row in rows] == pytest.approx([1.4, 1.0, 1.9])
    assert f"best    s/1   rmse1_deg + 0*e_max_deg 1   {KP}=0.9" in out
    assert f"next    hjcamp run {' '.join(SMALL)} {KP}=0.9 seed=2" in out


def test_an_objective_is_refused_before_anything_is_written(tuned: Call, tmp_path: Path) -> None:
    for words, said in (
        (("-m", f"{KP}=0.7,0.9", "objective=rmse3_deg"), "did you mean 'rmse"),
        (("objective=3",), "names no indicator"),
        (("-m", f"{KP}=interval(0.5,1.5)", "objective=rmse1_deg"), "hydra/sweeper=optuna"),
        (("-m", f"{KP}=0.7,0.9", "hydra/sweeper=optun"), "unknown hydra/sweeper 'optun'"),
    ):
        code, _, err = tuned("run", *SMALL, *words)
        assert code == 2 and said in err and err.count("\n") == 1, err
    assert list(tmp_path.iterdir()) == []


def test_an_objective_that_the_tests_lack_fails_with_the_condition(tuned: Call) -> None:
    code, _, err = tuned("run", *SMALL, "objective=sse_deg")
    assert code == 1 and "2 tests have no sse_deg (sine_0p5hz__pid)" in err


def test_the_plan_of_a_sweep(tuned: Call, tmp_path: Path) -> None:
    code, out, err = tuned("plan", "-m", *SMALL, f"{KP}=0.7,0.9,1.2", "objective=rmse1_deg")
    assert (code, err) == (0, ""), err
    assert "3 jobs" in out and "in all  6 tests" in out and f"{KP}=1.2" in out
    assert "next    hjcamp run -m campaign=robustness_vertical" in out
    assert tuned("plan", "-m", *SMALL, "--json")[0] == 2
    assert list(tmp_path.iterdir()) == []


def test_optuna_looks_for_the_gain(tuned: Call, tmp_path: Path) -> None:
    search = (
        "hydra/sweeper=optuna",
        "hydra.sweeper.n_trials=3",
        "hydra.sweeper.sampler.seed=1",
        f"{KP}=interval(0.5,1.5)",
    )
    code, out, err = tuned("plan", "-m", *SMALL, *search, "objective=rmse1_deg")
    assert code == 0 and "3 jobs" in out and "in all  6 tests" in out, err
    code, out, err = tuned("run", "-m", *SMALL, *search, "objective=rmse1_deg", "run_dir=s")
    assert code == 0, err
    with (tmp_path / "s" / "sweep.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 3
    best = min(rows, key=lambda row: float(row["rmse1_deg"]))
    assert f"{KP}={best[KP]}" in out.partition("next")[2]
    # one line a job, nothing of Hydra, optuna or the storage
    lines = out.splitlines()
    assert [line.split("   ")[0] for line in lines[:3]] == [f"job {number}" for number in range(3)]
    assert lines[3] == "the runs of the sweep are in s" and len(lines) == 7 and err == ""
    assert all(f"   {KP}={row[KP]}   " in line for row, line in zip(rows, lines, strict=False))
    for words, said in (
        (("hydra.sweeper.direction=[minimize,minimize]", "objective=rmse1_deg"), "1 objective and 2"),
        (("hydra.sweeper.direction=up", "objective=rmse1_deg"), "'minimize' or 'maximize'"),
        (("hydra.sweeper.n_trials=0", "objective=rmse1_deg"), "hydra.sweeper.n_trials is 0; a whole number from 1"),
        (("hydra.sweeper.sampler.seed=-1", "objective=rmse1_deg"), "hydra.sweeper.sampler.seed is -1"),
        (("hydra.sweeper.storage=nowhere", "objective=rmse1_deg"), "hydra.sweeper.storage=nowhere cannot be used"),
        ((), "give objective=INDICATOR"),
    ):
        code, _, err = tuned("run", "-m", *SMALL, *search, *words)
        assert code == 2 and said in err, err


def test_a_trial_that_fails_ends_the_sweep_with_its_message(tuned: Call) -> None:
    search = ("hydra/sweeper=optuna", f"{KP}=interval(0.5,1.5)", "objective=sse_deg")
    code, _, err = tuned("run", "-m", *SMALL, *search)
    assert code == 1 and "job 0: objective=sse_deg: 2 tests have no sse_deg" in err


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ("interval(1.5,0.5)", "must rise"),
        ("interval(1,1)", "must rise"),
        ("interval(nan,1)", "finite"),
        ("interval(0,inf)", "finite"),
        ("tag(log,interval(0,1))", "above 0"),
        ("tag(log,interval(-1,1))", "above 0"),
        ("tag(log,range(1,3))", "tag(log, interval(a,b))"),
        ("range(5,1)", "holds no number"),
        ("range(0,1,-0.1)", "holds no number"),
        ("range(0,1,0)", "holds no number"),
        ("range(1,2,nan)", "finite"),
    ],
)
def test_a_range_that_holds_no_number_is_refused_in_one_sentence(tuned: Call, tmp_path: Path, values: str, why: str) -> None:
    for command in ("plan", "run"):
        code, _, err = tuned(command, "-m", *SMALL, "hydra/sweeper=optuna", f"{KP}={values}", "objective=rmse1_deg")
        assert code == 2 and why in err and f"{KP}={values}" in err and err.count("\n") == 1, err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("seed=1,2", "controller.positive.kp=range(1,2,0.001)"), 2, "2000 jobs: --yes begins a sweep of more than 1000"),
        (("seed=range(1,100000000)",), 2, "99999999 jobs; a sweep has at most 100000"),
        (("--yes", "seed=range(1,100000000)"), 2, "99999999 jobs; a sweep has at most 100000"),
    ],
)
def test_a_sweep_of_thousands_is_not_begun_without_a_word(
    tuned: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], code: int, said: str
) -> None:
    monkeypatch.setattr("hjcamp.campaign.plan.sweep.CHECKED_JOBS", 2)
    got, _, err = tuned("run", "-m", *SMALL, *words)
    assert got == code and said in err and err.count("\n") == 1, err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("answer", "begins"), [(True, True), (False, False)])
def test_a_terminal_is_asked_before_a_sweep_of_thousands(monkeypatch: pytest.MonkeyPatch, answer: bool, begins: bool) -> None:
    asked: list[str] = []
    for name in ("stdin", "stdout"):
        monkeypatch.setattr(getattr(run.sys, name), "isatty", lambda: True)
    monkeypatch.setattr(run.typer, "confirm", lambda question: asked.append(question) or answer)
    run.confirm(run.UNASKED_JOBS, False)
    run.confirm(10**6, True)
    assert asked == []
    if begins:
        run.confirm(1001, False)
    else:
        with pytest.raises(UsageError, match="nothing was run"):
            run.confirm(1001, False)
    assert asked == ["1001 jobs. Begin?"]
