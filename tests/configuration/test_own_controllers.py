"""A campaign with a controller that the usual configuration has not: its parameters and gain sets are given as any other."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from hjcamp.campaign.tuning import retune_law
from hjcamp.cli import run
from hjcamp.commands.campaigns.plan import compose_plan
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.fitted import fitted

CAMPAIGN = """description: a carriage that follows a sine
fixed:
  plant: carriage
  controller: plain_pid
  controller.kp: 500
  controller.kd: 20
  trajectory.amplitude_m: 0.1
  trajectory.duration: 0.2
vary: {trajectory: [sine]}
repetitions: 1
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in {
        "plants/carriage.py": TEMPLATE.format(title="Carriage"),
        "campaigns/own.yaml": CAMPAIGN,
        "conf/controller/gains/mine.yaml": "# @package controller\nkp: 1500\nkd: 60\n",
    }.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(text)
    return tmp_path


def gains(*words: str) -> tuple[float, float]:
    [condition] = compose_plan(list(words)).conditions
    return condition.config["controller"]["kp"], condition.config["controller"]["kd"]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), (500, 20)),
        (("controller.kp=100",), (100, 20)),
        (("++controller.kp=100",), (100, 20)),
        # a gain set takes the place of what the campaign fixes, a parameter that is given by hand of both
        (("controller/gains=mine",), (1500, 60)),
        (("+controller/gains=mine",), (1500, 60)),
        (("controller/gains=mine", "controller.kd=7"), (1500, 7)),
    ],
)
def test_parameters_and_gain_sets_are_those_of_the_campaigns_controller(
    folder: Path, words: tuple[str, ...], expected: tuple[float, float]
) -> None:
    assert gains("campaign=own", *words) == expected


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("campaign=own", "controller.kpp=1"), "unknown parameter 'kpp' in controller; did you mean 'kp'?"),
        (("campaign=own", "controller.positive.kp=1"), "unknown parameter 'positive' in controller"),
        (("campaign=own", "controller/gains=min"), "did you mean 'mine'?"),
        (("campaign=own", "controler.kp=1"), "did you mean 'controller'?"),
        (("controller.kp=1",), "unknown parameter 'kp' in controller"),
    ],
)
def test_what_no_controller_has_is_refused_in_a_line(
    folder: Path, words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for command in ("plan", "run"):
        assert run([command, *words]) == 2
        error = capsys.readouterr().err
        assert said in error and error.count("\n") == 1 and not Path("runs").exists()


def test_a_sweep_takes_them_too(folder: Path) -> None:
    assert run(["run", "-m", "campaign=own", "controller/gains=mine", "controller.ki=100,200", "hydra.sweep.dir=both"]) == 0
    plans = [json.loads(path.read_text()) for path in sorted(Path("both").glob("*/plan.json"))]
    found: list[dict[str, Any]] = [one["conditions"][0]["config"]["controller"] for one in plans]
    assert [(one["kp"], one["ki"]) for one in found] == [(1500, 100), (1500, 200)]


def test_what_tune_prints_is_what_a_run_takes(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(retune_law, "GENERATIONS", 1)
    monkeypatch.setattr(retune_law, "MEMBERS", 1)
    assert run(["tune", "campaign=own", "--as", "found", "--json", "a.json"]) == 0
    [case] = json.loads(Path("a.json").read_text())["cases"]
    # sought from what the campaign says; an integral gain of 0 stays 0
    assert case["gains"].keys() == {"kp", "kd"} and 500 / 3 <= case["gains"]["kp"] <= 1501
    assert case["mean_error_after"] <= case["mean_error_before"]
    told = re.search(r"use (\S+)", capsys.readouterr().out)
    assert told is not None
    for words in (["campaign=own"], ["plant=carriage", "controller=plain_pid"]):
        assert gains(*words, told[1]) == pytest.approx((case["gains"]["kp"], case["gains"]["kd"]), rel=1e-3)


def test_gains_of_nothing_are_not_tuned(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["tune", "campaign=own", "controller.kp=0", "controller.kd=0", "--as", "found"]
    assert run(words) == 2
    assert "kp, ki, kd are 0; a search in factors begins at other values" in capsys.readouterr().err
    assert not Path("conf/controller/gains/found.yaml").exists()


def test_hydras_own_sign_is_put_where_a_choice_lacks_the_group(folder: Path) -> None:
    composer = Composer()
    assert fitted(["controller/gains=mine"], composer) == ["controller/gains=mine"]
    assert fitted(["hydra/sweeper=optuna"], composer) == ["hydra/sweeper=optuna"]  # Hydra's own groups have a choice always
    assert fitted(["plant=carriage", "controller=plain_pid", "controller/gains=mine"], composer)[-1] == "+controller/gains=mine"
    assert fitted(["controller=pid", "+controller/gains=mine"], composer)[-1] == "controller/gains=mine"
