"""Configurations joined from parts are those that Hydra composes, to the order of their keys."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from hjcamp.campaign.plan.campaign_file import read_campaign
from hjcamp.campaign.plan.conditions import draft_conditions
from hjcamp.configuration import composer as composer_module
from hjcamp.configuration import hydra_plugins, search_path, shared_parts
from hjcamp.configuration.composer import Composer, Composition
from hjcamp.configuration.overrides import parse_overrides
from hjcamp.configuration.search_path import packaged_root
from hjcamp.configuration.variation import NotJoinedError, Variations
from hjcamp.errors import UsageError

CAMPAIGNS = sorted(path.stem for path in (packaged_root() / "campaigns").glob("*.yaml"))
OTHERS = {
    "nothing": (),
    "two groups that write effects": ("payload=brass_8p5g", "orientation=vertical"),
    "gains inside a controller": ("controller=ffwd_pid", "controller/gains=simulation", "controller.positive.kp=1"),
    "an effect of one's own": ("++effects.leakage.conductance=1e-15", "++effects.leakage.threshold=6e5"),
    "what others refer to": ("amplifier=low_gain", "amplifier.full_scale_v=5.5", "controller=pid"),
    "a choice that brings another": ("pump=pump1",),
    "a choice that would bring another than is asked for": ("pump=pump1", "amplifier=high_gain"),
    "a choice that brings what is asked for": ("amplifier=low_gain", "amplifier.full_scale_v=5.5", "pump=pump1"),
    "a rig": ("backend=nidaqmx", "rig=example_pxie", "rig.limits.arm_deg=100"),
    "null and text": ("joint.travel_stop_deg=90", "run_dir=null", "seed=7", "rig.calibration=mine"),
}


@pytest.fixture(scope="module")
def composer() -> Composer:
    return Composer()


def by_hydra(composer: Composer, lines: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> Composition:
    def never(self: Variations, overrides: object) -> None:
        raise NotJoinedError

    with monkeypatch.context() as patch:
        patch.setattr(Variations, "compose", never)
        return composer.compose(lines)


def joined(composer: Composer, lines: tuple[str, ...]) -> Composition:
    found = composer._variations.compose(parse_overrides(lines))
    return Composition(found.config, found.choices)


def same(one: Composition, other: Composition) -> None:
    assert json.dumps(one.config) == json.dumps(other.config)
    assert json.dumps(one.choices) == json.dumps(other.choices)


LONG = {
    "bandwidth", "two_pumps", "valve_timing", "dither_map", "preload", "first_state", "stiffness", "controllers", "pid_design",
    "previous_work",
}  # fmt: skip


@pytest.mark.parametrize("name", [pytest.param(one, marks=pytest.mark.study) if one in LONG else one for one in CAMPAIGNS])
def test_every_condition_of_a_campaign(composer: Composer, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = read_campaign(composer.compose([f"campaign={name}"]).config["campaign"], name)
    for draft in draft_conditions(campaign, [], composer, 10_000)[1]:
        same(joined(composer, draft.overrides), by_hydra(composer, draft.overrides, monkeypatch))


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_a_campaign_itself(composer: Composer, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = (f"campaign={name}",)
    for _ in range(2):
        same(joined(composer, lines), by_hydra(composer, lines, monkeypatch))


@pytest.mark.parametrize(
    "lines",
    [
        ("campaign=controllers", "controller.positive.kp=3", "payload=brass_8p5g"),
        ("payload=brass_8p5g", "campaign=controllers", "++effects.leakage.conductance=1e-15"),
        ("campaign=controllers", "~controller.positive.kp"),
        ("campaign=controllers", "plant=two_pumps", "repetitions=2"),
    ],
    ids=" ".join,
)
def test_a_campaign_with_more(composer: Composer, lines: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    same(joined(composer, lines), by_hydra(composer, lines, monkeypatch))


def test_a_campaign_with_values_is_not_kept_since_there_are_any_number_of_them(composer: Composer) -> None:
    variations = composer._variations
    joined(composer, ("campaign=controllers", "payload=brass_8p5g"))
    kept = {*variations._shared, *variations._of_plants}
    assert ("campaign=controllers", "payload=brass_8p5g") in variations._shared
    for kp in (0.5, 0.6):
        joined(composer, ("campaign=controllers", f"controller.positive.kp={kp}"))
    assert {*variations._shared, *variations._of_plants} == kept


@pytest.mark.parametrize("name", OTHERS)
def test_other_overrides(composer: Composer, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    same(joined(composer, OTHERS[name]), by_hydra(composer, OTHERS[name], monkeypatch))


@pytest.mark.parametrize(
    "line",
    [
        "~effects",
        "controller.positive=3",
        "+pump.bore_mm=3",
        "pump.bore=3",
        "trajectory={kind: ramp}",
        "hydra.verbose=true",
        "hydra/sweeper=optuna",
        "pump=pump1,pump2",
    ],
)
def test_what_is_left_to_hydra(composer: Composer, line: str) -> None:
    with pytest.raises(NotJoinedError):
        composer._variations.compose(parse_overrides([line]))


def test_what_one_composition_is_given_does_not_reach_the_next(composer: Composer) -> None:
    first = composer.compose(["controller.positive.kp=1.5"]).config
    first["controller"]["positive"]["ki"] = -1.0
    second = composer.compose(["controller=pid"]).config
    assert second["controller"]["positive"] != first["controller"]["positive"]
    assert second["controller"]["positive"]["ki"] > 0


def test_what_one_group_brings_by_the_choice_of_another_is_left_to_hydra(tmp_path: Path) -> None:
    (tmp_path / "tubing").mkdir()
    (tmp_path / "tubing" / "mine.yaml").write_text("defaults: [like: '${payload}', _self_]\nname: ldpe_300mm\n")
    (tmp_path / "tubing" / "like").mkdir()
    for payload, stiffness in (("none", 0.02), ("brass_8p5g", 0.03)):
        text = f"# @package tubing\nstiffness_mpa_per_mm3: {stiffness}\n"
        (tmp_path / "tubing" / "like" / f"{payload}.yaml").write_text(text)
    composer = Composer(folder=tmp_path)
    with pytest.raises(NotJoinedError):
        composer._variations.compose(parse_overrides(["tubing=mine"]))
    found = composer.compose(["tubing=mine", "payload=brass_8p5g"]).config["tubing"]
    assert found["stiffness_mpa_per_mm3"] == 0.03


def test_composers_over_the_same_files_compose_a_part_once(monkeypatch: pytest.MonkeyPatch) -> None:
    first = Composer().compose(["payload=brass_8p5g", "joint.travel_stop_deg=90"])

    def never(*given: object) -> None:
        raise AssertionError("composed anew")

    monkeypatch.setattr(Composer, "_load", never)
    again = Composer()
    same(again.compose(["payload=brass_8p5g", "joint.travel_stop_deg=90"]), first)
    assert again.compose(["payload=brass_8p5g"]).config["joint"]["travel_stop_deg"] != 90


def test_a_file_that_changed_is_composed_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for group in ("conf", "campaigns"):
        shutil.copytree(packaged_root() / group, tmp_path / group)
    monkeypatch.setattr(composer_module, "packaged_root", lambda: tmp_path)
    monkeypatch.setattr(shared_parts, "packaged_root", lambda: tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(hydra_plugins, "packaged_root", lambda: tmp_path)
    monkeypatch.setattr(search_path, "packaged_root", lambda: tmp_path)
    file = tmp_path / "conf" / "payload" / "brass_8p5g.yaml"
    before = Composer().compose(["payload=brass_8p5g"]).config
    file.write_text(file.read_text().replace("mass_g: 8.5", "mass_g: 8.25"))
    after = Composer().compose(["payload=brass_8p5g"]).config
    assert before["payload"] != after["payload"]


def test_a_part_made_with_further_places_is_not_kept_for_others(tmp_path: Path) -> None:
    (tmp_path / "payload").mkdir()
    (tmp_path / "payload" / "mine.yaml").write_text("name: mine\n")
    composer = Composer()
    composer.compose([f"hydra.searchpath=[file://{tmp_path}]", "payload=mine"])
    with pytest.raises(UsageError, match="payload"):
        composer.compose(["payload=mine"])
    with pytest.raises(UsageError, match="payload"):
        Composer().compose(["payload=mine"])
