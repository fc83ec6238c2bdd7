"""A budget's parts by hand, against a configuration that says the same, and its command."""

from __future__ import annotations

import copy
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.simulation import model_values
from hjcamp.plants.pump_joint.sizing import dynamics
from hjcamp.plants.pump_joint.studies import budget as work
from hjcamp.plants.pump_joint.studies.budget import Item, better_by, budget, errors_of, variants
from hjcamp.plants.pump_joint.studies.retune import Retuned, gains_of, retune

SHORT = [
    "trajectory=ramp_pos",
    "controller=pid",
    "trajectory.amplitude_deg=30",
    "trajectory.rise_time=0.2",
    "trajectory.duration=0.3",
]


@pytest.fixture
def config(composer: Composer) -> dict[str, Any]:
    plan = make_plan(composer.compose(SHORT).config, None, SHORT, composer)
    return plan.conditions[0].config


def test_each_part_by_hand(config: dict[str, Any]) -> None:
    parts = better_by(model_values(config)[0], 0.5)
    assert parts["friction"]["static_positive"] == 3.6 and parts["friction"]["viscous_negative"] == pytest.approx(8.6)
    assert parts["static above Coulomb friction"]["static_positive"] == pytest.approx(5.27 + 0.5 * 1.93)
    assert parts["compliance of the lines"]["line_stiffness"] == pytest.approx(2 * 0.0257e15)
    even = parts["friction difference of the directions"]
    assert even["coulomb_positive"] == pytest.approx(0.75 * 5.27 + 0.25 * 2.97)
    assert even["coulomb_negative"] == pytest.approx(0.25 * 5.27 + 0.75 * 2.97)
    lag, before = parts["lag of the pump"], model_values(config)[0]
    assert lag["pump_gain"] / lag["pump_a0"] == pytest.approx(before["pump_gain"] / before["pump_a0"])
    assert dynamics.bandwidth(lag["pump_a2"], lag["pump_a1"], lag["pump_a0"]) == pytest.approx(2 * 20.695, rel=1e-4)


def test_a_stiffer_line_is_the_tubing_that_says_so(config: dict[str, Any]) -> None:
    other = copy.deepcopy(config)
    other["tubing"]["stiffness_mpa_per_mm3"] *= 2.0
    better = dict(variants(config, 0.5))["compliance of the lines"]
    assert np.allclose(errors_of(better, 1, 3), errors_of(other, 1, 3), rtol=1e-9)
    assert not np.allclose(errors_of(better, 1, 3), errors_of(config, 1, 3), rtol=1e-3)


def test_effects_are_removed_and_the_adjustment_follows_friction(config: dict[str, Any]) -> None:
    config = {**config, "effects": {"leakage": {"conductance": 1e-15}}}
    made = dict(variants(config, 0.5))
    assert made["effect leakage"]["effects"] == {} and made["nothing"]["effects"] == config["effects"]
    assert made["friction"]["procedure"]["adjustment"]["positive_mpa"] == pytest.approx(0.1)
    assert made["moving mass"]["procedure"]["adjustment"]["positive_mpa"] == 0.2
    assert config["procedure"]["adjustment"]["positive_mpa"] == 0.2


def test_smallest_first_and_a_part_that_fails_has_its_reason(composer: Composer, monkeypatch: pytest.MonkeyPatch) -> None:
    def errors(config: dict[str, Any], repetitions: int, seed: int) -> np.ndarray:
        given = config["model"].get("parameters") or {}
        if "moving_mass" in given:
            raise HjcampError("it ran away")
        return np.full((repetitions, 2), 0.5 if "pump_delay" in given else 2.0 if given else 1.0)

    monkeypatch.setattr(work, "errors_of", errors)
    condition = make_plan(composer.compose(SHORT).config, None, SHORT, composer).conditions[0]
    items = budget(condition, 0.5, 2, 1, tuned=False)
    assert [items[0].name, items[1].name, items[-1].name] == ["nothing", "delay of the pump", "moving mass"]
    assert items[-1].problem == "it ran away" and len(items) == 10


def test_gains_that_harm_are_not_taken() -> None:
    good, bad = np.full((2, 2), 1.0), np.full((2, 2), 3.0)
    assert Item("x", good, bad).best is good and Item("x", bad, good).best is good
    assert Item("x", good, np.empty((0, 2))).best is good


def test_tuned_gains_that_run_away_leave_the_part_with_the_old_ones(
    composer: Composer, monkeypatch: pytest.MonkeyPatch
) -> None:
    condition = make_plan(composer.compose(SHORT).config, None, SHORT, composer).conditions[0]
    wild = {side: {"kp": 1e3, "ki": 0.0, "kd": 0.0} for side in ("positive", "negative")}

    def errors(config: dict[str, Any], repetitions: int, seed: int) -> np.ndarray:
        if config["controller"]["positive"] == wild["positive"]:
            raise HjcampError("it ran away")
        return np.ones((repetitions, 2))

    monkeypatch.setattr(work, "retune", lambda conditions, start, *rest, **more: Retuned(start, wild, 1.0, 0.5, 1, ()))
    monkeypatch.setattr(work, "errors_of", errors)
    items = budget(condition, 0.5, 2, 1, tuned=True)
    assert not any(one.problem for one in items) and all(one.best is one.kept for one in items)


def test_gains_are_tuned_on_draws_that_do_not_judge_them(composer: Composer, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, ...]] = []

    def retune(conditions: Any, start: Any, seed: int, draws: Sequence[int] = ()) -> Retuned:
        asked.append(tuple(draws))
        return Retuned(start, start, 1.0, 1.0, 1, ())

    monkeypatch.setattr(work, "retune", retune)
    monkeypatch.setattr(work, "errors_of", lambda config, repetitions, seed: np.ones((repetitions, 2)))
    condition = make_plan(composer.compose(SHORT).config, None, SHORT, composer).conditions[0]
    budget(condition, 0.5, 100, 7, tuned=True)
    assert set(asked) == {tuple(range(1007, 1015))}


def test_tuned_gains_carry_over_to_other_tests(composer: Composer) -> None:
    """Half the friction of the refitted model: gains tuned on one test without scatter did worse than the old ones."""
    lines = ["trajectory=sine_0p5hz", "controller=ffwd_pid", "model=refit"]
    condition = make_plan(composer.compose(lines).config, None, lines, composer).conditions[0]
    config = dict(variants(condition.config, 0.5))["friction"]
    start = gains_of(config, "here")
    found = retune([replace(condition, config=config)], start, 1, draws=range(1001, 1009))
    tuned = {**config, "controller": {**config["controller"], **found.gains}}
    before, after = (errors_of(one, 3, 1)[:, 0].mean() for one in (config, tuned))
    assert after < 0.9 * before


def test_the_command(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    call = ["budget", *SHORT, "--keep-gains", "--repetitions", "1", "--json", "b.json", "--figure", "bars.svg"]
    assert cli.run(call) == 0
    found = json.loads(Path("b.json").read_text())
    assert found["schema"] == "hjcamp.budget/1" and found["rows"][0]["part"] == "nothing"
    kept = [row["gains_kept"]["rmse1_deg_mean"] for row in found["rows"][1:] if row["gains_kept"]]
    assert kept == sorted(kept) and len(found["rows"]) == 10
    assert "larger than as it is" in Path("bars.svg").read_text() and "friction" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["campaign=controllers"], "a budget is of one test, not of 14"),
        (["controller=open_loop", "trajectory=hold"], "has no gains to tune"),
        (["plant=two_pumps", "--keep-gains"], "plant two_pumps: a budget knows the parts of pump_joint alone"),
        (["plant=valve_joint", "controller=pva", "--keep-gains"], "plant valve_joint: a budget knows"),
        (["trajectory=rampp"], "unknown trajectory 'rampp'"),
        (["--figure", "bars.txt"], "the suffix must be one of"),
        (["--share", "1.5"], "--share"),
        (["--seed", "-1"], "--seed"),
    ],
)
def test_misuse_is_one_line(words: list[str], said: str, empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["budget", *words]) == 2
    err = capfd.readouterr().err
    assert said in err and len(err.strip().splitlines()) == 1
    assert not list(empty_folder.iterdir())
