"""The schema of each file that users write and the program agree: what comes along passes, a typo fails in both."""

from __future__ import annotations

import copy
import functools
import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator

from hjcamp.campaign.plan.campaign_file import read_campaign
from hjcamp.campaign.plan.new_file import write_campaign
from hjcamp.cli import run
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.file_models import SavedModel
from hjcamp.configuration.file_schemas import KINDS, file_schema, names
from hjcamp.configuration.saved_model import write_model
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant, usual_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.schema import checked

ROOT = Path(__file__).parents[2]
CAMPAIGNS = sorted((ROOT / "campaigns").glob("*.yaml"))
GROUPS = [one for one in names() if one not in KINDS]
CHOICES = [path for group in (*GROUPS, "rig") for path in sorted((ROOT / "conf" / group).glob("*.yaml")) if path.stem[0] != "_"]
MODELS = sorted((ROOT / "conf" / "model").glob("*.yaml"))


def content_of(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return found


@functools.cache
def validator(name: str, plant: str | None) -> Draft202012Validator:
    schema = file_schema(name, find_plant(plant) if plant else None)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def faults(name: str, content: Any, plant: str | None = None) -> list[str]:
    return [one.message for one in validator(name, plant).iter_errors(content)]


@pytest.mark.parametrize("path", CAMPAIGNS, ids=lambda path: path.stem)
def test_every_campaign_that_comes_along_passes(path: Path) -> None:
    content = content_of(path)
    assert not faults("campaign", content, (content.get("fixed") or {}).get("plant"))


@pytest.mark.parametrize("path", [*CHOICES, *MODELS], ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_every_choice_that_comes_along_passes(path: Path) -> None:
    content = content_of(path)
    if path.parent.name == "procedure" and content["name"] in ("two_pumps", "valve", "at_once"):
        return  # of other plants
    assert not faults(path.parent.name, content)


def test_a_whole_configuration_passes() -> None:
    for words in ([], ["backend=nidaqmx", "rig=example_pcie"], ["model=refit", "campaign=controllers"]):
        config = Composer().compose(words).config
        assert not faults("settings", json.loads(json.dumps(config)))


def misspelt(content: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Each key at the top and one level below without its last letter but one, in a copy of the content each."""
    found = []
    for key, value in content.items():
        places = [((), key), *(((key,), one) for one in (value if isinstance(value, dict) else ()))]
        for parents, name in places:
            changed = copy.deepcopy(content)
            holder = changed
            for one in parents:
                holder = holder[one]
            if len(name) > 3:
                holder[name[:-2] + name[-1]] = holder.pop(name)
                found.append((".".join([*parents, name]), changed))
    return found


@pytest.mark.parametrize(
    "group", ["pump", "tubing", "joint", "friction", "payload", "orientation", "procedure", "amplifier", "rig"]
)
def test_a_misspelt_key_of_a_choice_fails_in_both_with_the_nearest_one(group: str) -> None:
    config = Composer().compose([]).config
    cases = misspelt({key: value for key, value in config[group].items() if value is not None})
    assert cases
    for where, changed in cases:
        if where.startswith(("transfer_function.", "gains.")):  # of any name; one that is not given
            continue
        assert faults(group, changed), where
        with pytest.raises(UsageError, match="did you mean"):
            check_configuration({**config, group: changed})


CAMPAIGN: dict[str, Any] = {
    "name": "mine",
    "description": "Steps",
    "fixed": {"controller": "pid", "trajectory.amplitude_deg": 20.0, "start": {"arm": 0.1}},
    "vary": {
        "payload": ["none", "brass_8p5g"],
        "case": {"slow": {"trajectory": "sine_0p5hz"}, "fast": {"trajectory": "sine_1hz"}},
    },
    "repetitions": 3,
    "seed": 2,
    "tables": ["5.4.1"],
}
TYPOS: dict[str, dict[str, Any]] = {
    "a key": {"varry": {}},
    "a key for how often": {"repetition": 3},
    "no vary": {"vary": {}},
    "an empty axis": {"vary": {"controller": []}},
    "a word for an axis": {"vary": {"controller": "pid"}},
    "a list for what is fixed": {"fixed": ["payload"]},
    "a word for a number": {"repetitions": "three"},
    "a broken number": {"repetitions": 2.5},
    "no repetition": {"repetitions": 0},
    "a negative seed": {"seed": -1},
    "a number for a description": {"description": 5},
    "a number for tables": {"tables": [5.4]},
    "a mapping for tables": {"tables": {"a": 1}},
    "a list for a name": {"name": ["mine"]},
    "a case that is a word": {"vary": {"case": {"slow": "sine"}}},
}


def test_a_sound_campaign_is_sound_to_both() -> None:
    read_campaign(CAMPAIGN, "mine")
    assert not faults("campaign", CAMPAIGN)


@pytest.mark.parametrize("case", TYPOS)
def test_a_typo_in_a_campaign_fails_in_both(case: str) -> None:
    spoilt = CAMPAIGN | TYPOS[case]
    assert faults("campaign", spoilt)
    with pytest.raises(UsageError):
        read_campaign(spoilt, "mine")


@pytest.mark.parametrize(
    "change",
    [
        {"fixed": {"controler": "pid"}},
        {"fixed": {"controller": "pidd"}},
        {"fixed": {"paylod": "none"}},
        {"fixed": {"trajectry.amplitude_deg": 20.0}},
        {"vary": {"payload": ["brass"]}},
        {"vary": {"case": {"slow": {"trajectory": "sine_05hz"}, "fast": {"trajectory": "sine_1hz"}}}},
    ],
    ids=str,
)
def test_a_choice_that_does_not_exist_fails_in_both(
    change: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("campaigns").mkdir()
    spoilt = {key: value for key, value in CAMPAIGN.items() if key != "fixed"} | change
    Path("campaigns/mine.yaml").write_text(yaml.safe_dump(spoilt))
    assert faults("campaign", spoilt)
    assert run(["plan", "campaign=mine"]) == 2
    assert "did you mean" in capsys.readouterr().err


@pytest.mark.parametrize(
    "change",
    [{"parameter": {}}, {"effect": {}}, {"factors": []}, {"plant": 3}, {"period_s": "fast"}, {"provenence": {}}],
    ids=str,
)
def test_a_typo_in_a_model_fails_in_both(change: dict[str, Any]) -> None:
    sound = {"name": "mine", "parameters": {}, "effects": {}}
    assert not faults("model", sound)
    assert faults("model", sound | change)
    with pytest.raises(UsageError):
        checked(SavedModel, sound | change, "model")


def test_a_model_of_a_plant_knows_its_parameters_and_effects() -> None:
    sound = {"name": "mine", "parameters": {"moving_mass": 0.01}, "effects": {"leakage": {"conductance": 1e-15}}}
    assert not faults("model", sound, "pump_joint")
    assert faults("model", sound | {"parameters": {"moving_mas": 1.0}}, "pump_joint")
    assert faults("model", sound | {"effects": {"leakge": {}}}, "pump_joint")
    assert faults("model", sound | {"effects": {"leakage": {"conductanc": 1.0}}}, "pump_joint")


def test_files_that_the_program_begins_name_the_schema_that_stands_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    campaign, model = Path("campaigns/mine.yaml"), Path("conf/model/mine.yaml")
    write_campaign(campaign, CAMPAIGN, ["made by a test"])
    write_model(model, Candidate({"moving_mass": 0.01}, {}), ["made by a test"], {})
    for path in (campaign, model):
        first = path.read_text().splitlines()[0]
        assert first.startswith("# yaml-language-server: $schema=.schemas/")
        schema = json.loads((path.parent / first.partition("=")[2]).read_text())
        assert not list(Draft202012Validator(schema).iter_errors(content_of(path)))
        assert list(Draft202012Validator(schema).iter_errors({**content_of(path), "nmae": 1}))
    assert Composer().options("campaign") and "mine" in Composer().options("model")


@pytest.mark.parametrize("name", names())
def test_the_command_prints_each_schema(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["schema", name]) == 0
    Draft202012Validator.check_schema(json.loads(capsys.readouterr().out))


def test_the_groups_are_those_of_the_usual_plant() -> None:
    assert set(GROUPS) == set(usual_plant().settings())
