"""Composing: choices, effects of payload and orientation, the user's folders, messages."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.configuration.composer import Composer, as_override, free
from hjcamp.configuration.overrides import parse_overrides
from hjcamp.errors import UsageError

CAMPAIGN = "name: mine\nvary:\n  trajectory: [ramp_pos, mixed]\n"


def test_payload_and_orientation_are_effects_in_si(composer: Composer) -> None:
    config = composer.compose(["payload=brass_8p5g", "orientation=vertical"]).config
    assert config["payload"]["name"] == "brass_8p5g"
    assert config["effects"]["payload_inertia"] == {"load_mass": 0.0085, "radius": 0.02}
    assert config["effects"]["gravity_load"] == {"load_mass": 0.0085, "radius": 0.02, "rest_angle": 0.0}


def test_a_vertical_joint_without_payload_carries_nothing(composer: Composer) -> None:
    assert composer.compose(["orientation=vertical"]).config["effects"]["gravity_load"]["load_mass"] == 0.0


def test_a_composition_leaves_no_trace_in_the_next(composer: Composer) -> None:
    before = composer.compose([])
    composer.compose(["payload=brass_8p5g", "++effects.leakage.conductance=1e-13", "controller.positive.kp=9"])
    assert composer.compose([]) == before
    assert before.config["effects"] == {}


@pytest.mark.parametrize(
    ("choice", "gain", "static", "direction"),
    [("experiment", 1.23, False, "positive"), ("design", 1.0, True, "reference")],
)
def test_both_feedforwards_can_be_chosen(composer: Composer, choice: str, gain: float, static: bool, direction: str) -> None:
    config = composer.compose(["controller=ffwd_pid", f"controller/feedforward={choice}"]).config["controller"]
    expected = {"variant": choice, "gain": gain, "static_friction": static, "friction_direction": direction}
    assert config["feedforward"] == expected
    assert config["name"] == "ffwd_pid"
    assert config["positive"] == {"kp": 1.05, "ki": 70.0, "kd": 0.015}


def test_gains_of_the_simulation_can_be_chosen(composer: Composer) -> None:
    config = composer.compose(["controller/gains=simulation"]).config["controller"]
    assert config["negative"] == {"kp": 1.14, "ki": 55.0, "kd": 0.018}


def test_every_choice_composes(composer: Composer) -> None:
    groups = [group for group in composer.groups() if group not in ("campaign", "table", "plant")]
    options = {group: composer.options(group) for group in groups}
    for number in range(max(map(len, options.values()))):
        choices = {group: names[number % len(names)] for group, names in options.items()}
        config = composer.compose([f"{group}={choice}" for group, choice in choices.items()]).config
        assert {group: config[group]["name"] for group in groups} == choices


@pytest.mark.parametrize(
    ("lines", "amplifier"),
    [
        ([], "high_gain"),
        (["pump=pump1"], "low_gain"),
        (["campaign=robustness_vertical", "pump=pump1"], "low_gain"),
        (["pump=pump1", "amplifier=high_gain"], "high_gain"),
        (["pump=pump2", "amplifier=low_gain"], "low_gain"),
    ],
)
def test_a_pump_brings_its_amplifier_unless_one_is_asked_for(composer: Composer, lines: list[str], amplifier: str) -> None:
    found = composer.compose(lines)
    assert found.config["amplifier"]["name"] == found.choices["amplifier"] == amplifier
    # the pump before it, and after it
    again = composer.compose(lines[::-1])
    assert again.config["amplifier"] == found.config["amplifier"] and again.config["pump"] == found.config["pump"]


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("controller=pidd", ["unknown controller 'pidd'", "'pid'"]),
        ("controler=pid", ["'controler'", "did you mean 'controller'"]),
        ("trajectory=ramp_po", ["unknown trajectory", "did you mean 'ramp_pos'"]),
        ("controller.positive.kpp=1", ["'kpp' in controller.positive", "Allowed: kd, ki, kp"]),
        ("controller.positive.kp.x=1", ["controller.positive.kp is a value"]),
        ("repetition=3", ["did you mean 'repetitions'"]),
        ("campaign=contollers", ["unknown campaign", "did you mean 'controllers'"]),
        ("campaign=null", ["campaign=null"]),
        ("pump=null", ["Allowed: pump1, pump2"]),
        ("controller.model=nope", []),
        ("seed=${nope}", ["'nope' not found"]),
        ("a b", ["cannot read the override 'a b'"]),
        ("controller.positive.kp=[1,2", ["cannot read the override"]),
        ("=", ["Allowed"]),
        ("trajectory=ramp_pos,ramp_neg", ["--multirun"]),
    ],
)
def test_bad_overrides_are_one_line(composer: Composer, override: str, words: list[str]) -> None:
    if not words:
        assert composer.compose([override])
        return
    with pytest.raises(UsageError) as caught:
        composer.compose([override])
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_the_folder_one_works_in_comes_first(empty_folder: Path) -> None:
    (empty_folder / "campaigns").mkdir()
    (empty_folder / "campaigns" / "mine.yaml").write_text(CAMPAIGN)
    (empty_folder / "conf" / "payload").mkdir(parents=True)
    (empty_folder / "conf" / "payload" / "none.yaml").write_text("name: none\nmass_g: 1.0\nradius_mm: 5.0\n")
    composer = Composer()
    assert "mine" in composer.options("campaign")
    assert "controllers" in composer.options("campaign")
    composition = composer.compose(["campaign=mine"])
    assert composition.config["campaign"]["vary"] == {"trajectory": ["ramp_pos", "mixed"]}
    assert composition.config["payload"]["mass_g"] == 1.0


def test_a_named_folder_comes_before_the_one_worked_in(empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder, mass in (("here", 1.0), ("named", 2.0)):
        (empty_folder / folder / "conf" / "payload").mkdir(parents=True)
        (empty_folder / folder / "conf" / "payload" / "none.yaml").write_text(f"name: none\nmass_g: {mass}\nradius_mm: 5.0\n")
    monkeypatch.chdir(empty_folder / "here")
    assert Composer().compose([]).config["payload"]["mass_g"] == 1.0
    monkeypatch.setenv("HJCAMP_CONF", str(empty_folder / "named"))
    assert Composer().compose([]).config["payload"]["mass_g"] == 2.0
    monkeypatch.setenv("HJCAMP_CONF", str(empty_folder / "named" / "conf"))
    assert Composer().compose([]).config["payload"]["mass_g"] == 2.0


def test_a_damaged_user_file_is_named(empty_folder: Path) -> None:
    (empty_folder / "campaigns").mkdir()
    (empty_folder / "campaigns" / "mine.yaml").write_text("name: [unclosed\n")
    with pytest.raises(UsageError, match=r"mine\.yaml"):
        Composer().compose(["campaign=mine"])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.05, "a.b=1.05"),
        (True, "a.b=true"),
        (None, "a.b=null"),
        ([1, "x"], "a.b=[1,x]"),
        ({"kp": 1.0}, "a.b={kp:1.0}"),
        ("two words, 'quoted'", "a.b='two words, \\'quoted\\''"),
    ],
)
def test_values_survive_the_override_grammar(value: object, text: str) -> None:
    assert as_override("a.b", value) == text
    assert parse_overrides([text])[0].value() == value


def test_effects_need_no_plus() -> None:
    assert free("effects.leakage.conductance=1") == "++effects.leakage.conductance=1"
    assert free("controller=pid") == "controller=pid"
    assert as_override("effects.leakage.conductance", 1e-13) == "++effects.leakage.conductance=1e-13"


def test_completion(composer: Composer) -> None:
    assert composer.complete("campaign=rob") == ["campaign=robustness_horizontal", "campaign=robustness_vertical"]
    assert "controller.positive." in composer.complete("controller.p")
    assert composer.complete("controller.positive.k") == [f"controller.positive.k{name}=" for name in "dip"]
    assert "payload=" in composer.complete("pay")
    assert composer.complete("nothing_like_it") == []
