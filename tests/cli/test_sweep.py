"""A sweep whose jobs give a number: its plan, its best job, and a sweeper that looks for the best gain."""

from __future__ import annotations

import csv
import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import hjcamp.backends

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


needs_optuna = pytest.mark.skipif(
    importlib.util.find_spec("hydra_plugins") is None
    or importlib.util.find_spec("hydra_plugins.hydra_optuna_sweeper") is None,
    reason="the extra is not installed: pip install 'hjcamp[sweep]'",
)


@needs_optuna
# The versions that go together (constraints.txt) use calls that SQLAlchemy and optuna call old.
@pytest.mark.filterwarnings("ignore")
def test_optuna_finds_the_gain(tuned: Call, tmp_path: Path) -> None:
    search = (
        "hydra/sweeper=optuna",
        "hydra.sweeper.n_trials=8",
        "hydra.sweeper.sampler.seed=1",
        f"{KP}=interval(0.5,1.5)",
    )
    code, out, err = tuned("plan", "-m", *SMALL, *search, "objective=rmse1_deg")
    assert code == 0 and "8 jobs" in out and "in all  16 tests" in out, err
    code, out, err = tuned("run", "-m", *SMALL, *search, "objective=rmse1_deg", "run_dir=s")
    assert code == 0, err
    with (tmp_path / "s" / "sweep.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 8
    best = min(rows, key=lambda row: float(row["rmse1_deg"]))
    assert abs(float(best[KP]) - BEST) < 0.1
    assert f"{KP}={best[KP]}" in out.partition("next")[2]
    for words, said in (
        (("hydra.sweeper.direction=[minimize,minimize]", "objective=rmse1_deg"), "1 objective and 2"),
        ((), "give objective=INDICATOR"),
    ):
        code, _, err = tuned("run", "-m", *SMALL, *search, *words)
        assert code == 2 and said in err, err
