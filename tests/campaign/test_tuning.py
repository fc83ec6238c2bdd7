"""Gains from the simulated rig: the critical point, the seeded search, and the file that keeps them."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.tuning.gains_file import write_gains
from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError, UsageError
from hjcamp.plants.pump_joint.studies import retune as search
from hjcamp.plants.pump_joint.studies.critical_gain import critical_point, oscillation

GAINS = {"positive": {"kp": 1.0, "ki": 50.0, "kd": 0.01}, "negative": {"kp": 1.1, "ki": 60.0, "kd": 0.02}}


def test_the_loop_oscillates_from_the_critical_gain_on(composer: Composer, empty_folder: Path) -> None:
    point = critical_point(composer, [], 30.0)
    assert 1.5 < point.gain < 2.5
    assert 0.045 < point.period < 0.060
    assert oscillation(composer, [], 30.0, 0.98 * point.gain) is None
    assert oscillation(composer, [], 30.0, 1.02 * point.gain) is not None


def test_a_step_that_moves_nothing_has_no_critical_gain(composer: Composer, empty_folder: Path) -> None:
    heavy = [f"friction.{side}.static_n=5000" for side in ("positive", "negative")]
    with pytest.raises(HjcampError, match="does not oscillate at a gain of 50"):
        critical_point(composer, heavy, 30.0)


def test_a_search_is_repeated_exactly_and_never_worse(
    composer: Composer, empty_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "GENERATIONS", 1)
    monkeypatch.setattr(search, "MEMBERS", 1)
    lines = ["controller=pid", "repetitions=1"]
    plan = make_plan(composer.compose(lines).config, None, lines, composer)
    start = search.gains_of(plan.conditions[0].config, "here")
    first, second = (search.retune(plan.conditions, start, 3) for _ in range(2))
    assert first == second
    assert first.after <= first.before
    low, high = 1 / search.FACTOR, search.FACTOR
    for side, group in first.gains.items():
        assert all(0.99 * low < value / start[side][name] < 1.01 * high for name, value in group.items())


def test_gains_that_rounding_spoils_are_not_taken(
    composer: Composer, empty_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "GENERATIONS", 1)
    monkeypatch.setattr(search, "MEMBERS", 1)
    lines = ["controller=pid", "repetitions=1"]
    plan = make_plan(composer.compose(lines).config, None, lines, composer)
    start = search.gains_of(plan.conditions[0].config, "here")

    def rmse1(test: object, gains: search.Gains) -> float:
        kp = gains["positive"]["kp"]
        return 2.0 if gains == start else 3.0 if kp == float(f"{kp:.3g}") else 1.0  # deg

    monkeypatch.setattr(search._Test, "rmse1", rmse1)
    found = search.retune(plan.conditions, start, 3)
    assert found.gains == start and found.after == found.before == 2.0


def test_open_loop_has_no_gains_to_tune(composer: Composer) -> None:
    with pytest.raises(UsageError, match="'open_loop' has no gains"):
        search.gains_of(composer.compose(["controller=open_loop"]).config, "here")


def test_a_saved_gain_set_is_a_choice(empty_folder: Path) -> None:
    write_gains("mine", GAINS, ["from a test"], replace=False)
    assert not list(empty_folder.rglob("*.part"))
    controller = Composer().compose(["controller=pid", "controller/gains=mine"]).config["controller"]
    assert {side: controller[side] for side in GAINS} == GAINS
    with pytest.raises(UsageError, match="exists"):
        write_gains("mine", GAINS, [], replace=False)
    with pytest.raises(UsageError, match="cannot be the name of a gain set"):
        write_gains("../mine", GAINS, [], replace=False)


def test_the_retuned_gains_of_the_campaign_are_recorded_with_their_source(composer: Composer) -> None:
    for name in ("reduced_friction", "reduced_compliance", "ziegler_nichols"):
        assert name in composer.options("controller/gains")
        text = (Path(__file__).parents[2] / f"conf/controller/gains/{name}.yaml").read_text()
        assert "hjcamp tune" in text
