"""Hidden effects of the truth plant, through the commands: named among rivals, added, and the error comes down."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from discrepancy_answers import Call, read_answer
from truth.pump_joint.case import write_case

import hjcamp.effects

RIVALS = (
    "cross_leakage", "encoder_bias", "encoder_eccentricity", "encoder_lag", "entrained_air", "friction_drift", "gravity_load",
    "leakage", "position_friction", "pressure_friction", "stribeck_friction",
)  # fmt: skip


@pytest.fixture
def ask(call: Call, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Return ``call`` with a library in which the hidden effects have rivals of their own kind."""
    everything = hjcamp.effects.library_of("pump_joint", []).effects
    few = {name: everything[name] for name in RIVALS}
    monkeypatch.setattr(hjcamp.effects, "load_effects", lambda folders=None: dict(few))
    return call


def diagnosed(ask: Call, folder: Path, *effects: str, strength: str, seed: int) -> dict[str, Any]:
    """Hide the effects, diagnose at ``quick`` and return the answer."""
    write_case(folder, list(effects), strength, seed)
    answer = ask("diagnose", folder, "--effort", "quick", "--json", "d.json")
    assert answer.code == 0, answer.err
    return read_answer(Path("d.json"))


@pytest.mark.study
def test_a_hidden_effect_is_named_added_and_gone(ask: Call, tmp_path: Path) -> None:
    # One of the joint and one of the lines: test_missing_effect_commands.py; many of each: `make benchmark`.
    effect = "encoder_eccentricity"
    found = diagnosed(ask, tmp_path / "logs", effect, strength="medium", seed=32)
    assert (found["verdict"], found["effects"]) == ("effect", [effect])
    assert ask("add", effect, tmp_path / "logs", "--as", "bench", "--json", "a.json").code == 0
    error = read_answer(Path("a.json"))["error"]
    assert error["after"] <= 1.3 * error["floor"] < error["before"]


@pytest.mark.study
def test_two_hidden_effects_are_both_found(ask: Call, tmp_path: Path) -> None:
    found = diagnosed(ask, tmp_path / "logs", "leakage", "position_friction", strength="strong", seed=321)
    assert found["verdict"] == "effect"
    assert sorted(found["effects"]) == ["leakage", "position_friction"]


@pytest.mark.study
def test_a_stray_spring_is_outside_the_library_and_depends_on_the_arm_angle(ask: Call, tmp_path: Path) -> None:
    found = diagnosed(ask, tmp_path / "logs", "stray_spring", strength="strong", seed=311)
    assert (found["verdict"], found["effects"]) == ("outside_library", [])
    assert found["drivers"][0] == "arm_angle"
