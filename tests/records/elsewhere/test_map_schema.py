"""The schema of a map and the import agree: what one accepts, the other does, and typos fail in both."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from foreign_truth import CASES
from jsonschema import Draft7Validator

from hjcamp.cli import run
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.records.elsewhere.import_map import KEYS, read_import_map
from hjcamp.records.elsewhere.map_schema import OF_MAP, map_schema

ROOT = Path(__file__).parents[3]
SOUND: dict[str, Any] = {
    "plant": "stage", "period_s": 0.01, "header": True, "gaps": "interpolate", "spikes": "keep", "skip_lines": 2, "missing": [-9999],
    "fields": {"time_s": "t", "position_m": {"column": "x", "unit": "mm", "sign": -1, "scale": 2.0}, "voltage_v": {"column": 3}},
    "metadata": {"condition": "{file}"},
}  # fmt: skip
TYPOS: dict[str, Callable[[dict[str, Any]], object]] = {
    **{f"{key}s": lambda m, key=key: m.update({f"{key}s": 1}) for key in ("header", "gap", "planet", "topic", "separator")},
    **{f"{key} of a field": lambda m, key=key: m["fields"]["position_m"].update({key: 1}) for key in ("colum", "units")},
    "an unknown field": lambda m: m["fields"].update(positon_m="x"),
    "no column": lambda m: m["fields"]["position_m"].pop("column"),
    "no fields": lambda m: m.pop("fields"),
    "a sign of 2": lambda m: m["fields"]["position_m"].update(sign=2),
    "a word for gaps": lambda m: m.update(gaps="interpolat"),
    "a word for spikes": lambda m: m.update(spikes="drop"),
    "a header that is a word": lambda m: m.update(header="maybe"),
    "a plant that is a number": lambda m: m.update(plant=3),
    "a period of a day": lambda m: m.update(period_s=86400.0 * 100),
    "lines before the header": lambda m: m.update(skip_lines=-1),
    "a list for a column": lambda m: m["fields"].update(time_s=["t"]),
    "a list of metadata": lambda m: m.update(metadata=["a"]),
    "a list of units": lambda m: m["fields"]["position_m"].update(unit=["mm"]),
    "no files": lambda m: m.update(files={}),
}  # fmt: skip


def test_every_key_of_a_map_is_described() -> None:
    assert set(OF_MAP) | {"fields"} == set(KEYS)


def test_a_sound_map_is_sound_to_both(folder: Path) -> None:
    Path("map.yaml").write_text(yaml.safe_dump(SOUND))
    read_import_map(Path("map.yaml"))
    assert Draft7Validator(map_schema(find_plant("stage"))).is_valid(SOUND)


@pytest.mark.parametrize("case", TYPOS)
def test_a_typo_fails_in_both(folder: Path, case: str) -> None:
    spoilt = copy.deepcopy(SOUND)
    TYPOS[case](spoilt)
    Path("map.yaml").write_text(yaml.safe_dump(spoilt))
    with pytest.raises(UsageError):
        read_import_map(Path("map.yaml"))
    assert not Draft7Validator(map_schema(find_plant("stage"))).is_valid(spoilt)


@pytest.mark.parametrize(
    "path",
    [
        ROOT / "docs" / "own_plant" / "map.yaml",
        *sorted(set(CASES.glob("*/map.yaml")) - {CASES / "32_brackets_in_a_name" / "map.yaml"}),
    ],
    ids=lambda path: path.parent.name,
)
def test_every_map_that_comes_along_passes(path: Path) -> None:
    Draft7Validator(map_schema()).validate(yaml.safe_load(path.read_text()))


def test_the_command_prints_it_and_refuses_another_name(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["schema", "map", "--plant", "stage"]) == 0
    found = json.loads(capsys.readouterr().out)
    Draft7Validator.check_schema(found)
    assert set(found["properties"]["fields"]["properties"]) == {
        "time_s",
        "phase",
        "reference_position_m",
        "position_m",
        "voltage_v",
    }
    assert run(["schema", "mop"]) == 2 and "did you mean 'map'" in capsys.readouterr().err
