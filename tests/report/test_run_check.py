"""A run against a baseline, for any plant, and a repository that does it: the same is green, a changed parameter red."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from answer_schemas import check_answer

from hjcamp.cli import run
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log


def written(folder: str, conditions: dict[str, float], samples: int = 300, repetitions: int = 2) -> None:
    """Write logs of the usual plant: an arm that swings by a number of degrees in each condition."""
    time = 0.001 * np.arange(samples)
    for condition, swing in conditions.items():
        for repetition in range(repetitions):
            columns = {"time_s": time, "arm_deg": swing * np.sin(20.0 * time), "pressure1_mpa": 0.2 + 0.1 * time}
            columns |= {"pressure2_mpa": 0.2 - 0.1 * time, "pump_deg": 50.0 * time}
            metadata = {"condition": condition, "repetition": str(repetition)}
            write_log(Path(f"{folder}/{condition}_{repetition}.mcap"), TestLog(columns, metadata))


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("change", "code", "said"),
    [
        ({"conditions": {"a": 10.0, "b": 20.0}}, 0, ""),
        ({"conditions": {"a": 10.05, "b": 20.0}}, 0, ""),
        ({"conditions": {"a": 10.5, "b": 20.0}}, 1, "a: 'arm_deg' differs by"),
        ({"conditions": {"a": 10.0}}, 1, "b: is not in the run"),
        ({"conditions": {"a": 10.0, "b": 20.0, "c": 1.0}}, 1, "c: is not in the baseline"),
        ({"conditions": {"a": 10.0, "b": 20.0}, "samples": 299}, 1, "'arm_deg' has 299 samples, 300 before"),
        ({"conditions": {"a": 10.0, "b": 20.0}, "repetitions": 1}, 0, ""),
    ],
)
def test_each_course_is_held_against_the_baseline(
    change: dict, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    written("baseline", {"a": 10.0, "b": 20.0})
    written("new", **change)
    assert run(["check", "new", "--against", "baseline", "--json", "c.json", "--junit", "j.xml"]) == code
    assert said in capsys.readouterr().out
    answer = json.loads(Path("c.json").read_text())
    check_answer(answer)
    assert answer["within"] == (code == 0)
    suite = ElementTree.parse("j.xml").getroot()[0]
    assert int(suite.attrib["tests"]) == len(answer["courses"]) == len(suite)
    assert (
        int(suite.attrib["failures"]) == sum(not one["within"] for one in answer["courses"]) == len(suite.findall("*/failure"))
    )


@pytest.mark.parametrize(
    "words",
    [("--against", "nowhere"), ("--against", "baseline", "--tolerance", "2"), ("--against", "baseline", "--tolerance", "-0.1")],
)
def test_bad_calls_are_refused(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    written("baseline", {"a": 10.0})
    assert run(["check", "baseline", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_repository_checks_its_model_and_accepts_a_change(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["repository", "mine", "--plant", "cart"]) == 0
    monkeypatch.chdir("mine")
    steps = yaml.safe_load(Path(".github/workflows/check.yml").read_text())["jobs"]["check"]["steps"]
    calls = [step["run"].split()[1:] for step in steps if step.get("run", "").startswith("hjcamp")]
    assert [call[0] for call in calls] == ["run", "check"]
    assert run(["run", "campaign=check", "run_dir=baseline"]) == 0, capsys.readouterr().err
    assert [run(call) for call in calls] == [0, 0]
    shutil.rmtree("run")
    plant = Path("plants/cart.py")
    plant.write_text(plant.read_text().replace('"N", 20.0', '"N", 25.0'))
    assert [run(call) for call in calls] == [0, 1]
    # what README says
    shutil.rmtree("baseline")
    shutil.move("run", "baseline")
    assert [run(call) for call in calls] == [0, 0]
    assert "rm -r baseline && mv run baseline" in Path("README.md").read_text()


@pytest.mark.parametrize(("name", "said"), [("Cart", "small letters"), ("pump_joint", "taken")])
def test_a_name_that_no_plant_can_have_writes_nothing(name: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["repository", "mine", "--plant", name]) == 2
    assert said in capsys.readouterr().err and not Path("mine").exists()


def test_a_folder_that_is_not_empty_stays(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("mine")
    assert run(["repository", "mine"]) == 2 and "is not empty" in capsys.readouterr().err
    assert [path.name for path in Path("mine").iterdir()] == ["notes.txt"]
