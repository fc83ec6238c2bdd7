"""What the README tells a newcomer to write works as it stands there."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import hjcamp
from hjcamp import cli
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.commands import command_files
from hjcamp.configuration.composer import Composer
from hjcamp.effects import find_effect
from hjcamp.model.language.effect_units import check_units
from hjcamp.plants.pump_joint import PumpJoint

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    """Return the first block of the README in that language."""
    found = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert found, language
    return found[1]


def test_the_first_campaign_has_its_conditions(empty_folder: Path) -> None:
    (empty_folder / "campaigns").mkdir()
    (empty_folder / "campaigns" / "mine.yaml").write_text(block("yaml"))
    composer = Composer()
    asked = composer.compose(["campaign=mine"])
    plan = make_plan(asked.config, "mine", ["campaign=mine"], composer)
    assert [one.name for one in plan.conditions] == [
        f"{trajectory}__kp={gain}" for trajectory in ("ramp_pos", "cycloid_pos") for gain in ("1.05", "0.7")
    ]
    assert len(plan.tests) == 12


def test_the_first_effect_is_accepted(empty_folder: Path) -> None:
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "cable_drag.py").write_text(block("python"))
    effect = find_effect("cable_drag")
    check_units(effect, PumpJoint)
    assert effect.load_force(2.0, 0.5) == -1.0  # type: ignore[attr-defined]


def test_one_sentence_says_what_it_is_wherever_one_meets_it_first() -> None:
    sentence = README.split("\n\n")[1]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert sentence.endswith(".") and "\n" not in sentence and "joint" not in sentence
    assert project["description"] == cli.app.info.help == cli.root.__doc__ == sentence
    assert hjcamp.__doc__ is not None and hjcamp.__doc__.partition("\n")[0] == sentence


@pytest.mark.parametrize("page", ["README.md", "docs/commands.md"])
def test_every_command_it_names_is_there(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    named = set(re.findall(r"^(?:\.venv/bin/)?hjcamp ([a-z]+)|`hjcamp ([a-z]+)", text, re.MULTILINE))
    there = {first or second for first, second in named}
    assert there <= set(command_files())
    if page == "docs/commands.md":
        assert there == set(command_files())


def test_every_file_it_links_is_there_and_small() -> None:
    for link in re.findall(r"\]\(([^)]+)\)", README):
        assert (ROOT / link).stat().st_size < 300_000


def test_every_dependency_is_explained() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    listed = re.search(r"^dependencies = \[(.*?)^\]", text, re.DOTALL | re.MULTILINE)
    assert listed
    for name in re.findall(r'"([a-z0-9-]+)', listed[1]):
        assert re.search(rf"\b{name}\b", README), name


def test_the_page_of_an_own_plant_is_one_page_whose_exceptions_are_explained(capsys: pytest.CaptureFixture[str]) -> None:
    page = (ROOT / "docs" / "own_plant.md").read_text(encoding="utf-8")
    assert page.count("\n") <= 90
    asked = re.findall(r"`(?:hjcamp explain )?'([a-z ]+)'`", page)
    files = re.findall(r"`hjcamp explain ([a-z]+)` \(or (.*?)\)", page)[0]
    for word in (*asked, files[0], *re.findall(r"`(\w+)`", files[1])):
        assert cli.run(["explain", word]) == 0, capsys.readouterr().err
    assert len(asked) >= 5
