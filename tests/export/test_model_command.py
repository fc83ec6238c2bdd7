"""``hjcamp model export``: which model is meant, what is refused, and what the answer says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from answer_schemas import check_answer

from hjcamp import cli
from hjcamp.model.declare.plant import Plant

SAVED = """name: fitted
plant: carriage
period_s: 0.002
parameters: {coulomb: 33.0, delay.voltage: 0.0005}
effects: {cubic_spring: {}}
provenance: {command: hjcamp calibrate, logs: {a.csv: ab12}}
"""


def write(path: str, text: str) -> None:
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text(text, encoding="utf-8")


def exported(path: str) -> dict[str, object]:
    names: dict[str, object] = {}
    exec(Path(path).read_text(encoding="utf-8"), names)
    return names


def test_a_saved_model_goes_along_with_values_delay_period_and_source(carriage: type[Plant]) -> None:
    write("conf/model/fitted.yaml", SAVED)
    assert cli.run(["model", "export", "fitted", "--into", "mine.py", "--json", "answer.json"]) == 0
    answer = json.loads(Path("answer.json").read_text())
    check_answer(answer)
    found = exported("mine.py")
    assert found["PARAMETERS"]["coulomb"] == 33.0 == answer["parameters"]["coulomb"]
    assert "cubic_spring.stiffness" in found["PARAMETERS"]
    assert found["DELAYS"] == {"voltage": 0.0005} and found["PERIOD"] == 0.002
    assert found["SOURCE"]["of_the_model"]["logs"] == {"a.csv": "ab12"} and found["SOURCE"]["program"].startswith("hjcamp ")
    assert found["READINGS"] == {"encoder": ("position_m", "m", 1.0)}
    assert cli.run(["model", "export", "carriage", "--model", "fitted", "--into", "same.py"]) == 0
    assert exported("same.py")["PARAMETERS"] == found["PARAMETERS"]


def test_the_model_of_a_diagnosis_has_what_it_calibrated_and_the_effect_that_it_names(
    carriage: type[Plant], capsys: pytest.CaptureFixture[str]
) -> None:
    answer = {
        "schema": "hjcamp.diagnosis/2",
        "plant": "carriage",
        "verdict": "effect",
        "effects": ["cubic_spring"],
        "candidates": [{"effect": "cubic_spring", "parameters": {"stiffness": {"value": 7.5}}}],
        "calibration": {"mass": {"value": 90.0}},
        "calibration_with_effects": {"mass": {"value": 91.0}, "delay.voltage": {"value": 1e-4}},
    }
    write("diagnose/answer.json", json.dumps(answer))
    assert cli.run(["model", "export", "carriage", "--run", "diagnose"]) == 0
    found = exported("carriage.py")
    assert found["PARAMETERS"]["mass"] == 91.0 and found["PARAMETERS"]["cubic_spring.stiffness"] == 7.5
    assert found["DELAYS"] == {"voltage": 1e-4}
    write("diagnose/answer.json", json.dumps(answer | {"verdict": "outside_library", "effects": []}))
    assert cli.run(["model", "export", "carriage", "--run", "diagnose"]) == 0
    assert "without the law that the diagnosis found" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["export"], "give 'export' and one name"),
        (["import", "carriage"], "give 'export' and one name"),
        (["export", "carriag"], "did you mean 'carriage'"),
        (["export", "carriage", "--as", "pyton"], "did you mean 'python'"),
        (["export", "carriage", "--model", "none"], "unknown model 'none'"),
        (["export", "carriage", "--model", "published", "--run", "."], "either --model or --run"),
        (["export", "carriage", "--run", "."], "neither a run (plan.json) nor a diagnosis"),
        (["export", "carriage", "--condition", "a"], "give --run with it"),
        (["export", "carriage", "--into", "a.txt"], "ends in .py"),
        (["export", "carriage", "--into", "my-model.py"], "letters, digits and _"),
        (["export", "carriage", "--into", "conf/model/tabled.yaml/a.py"], "tabled.yaml"),
        (["export", "tabled"], "no part of a plant"),
    ],
)
def test_what_cannot_be_exported_is_refused_in_a_line(
    carriage: type[Plant], words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    write("conf/model/tabled.yaml", "parameters: {}\neffects: {}\nfactors: {pump_latency: 1.1}\n")
    assert cli.run(["model", *words]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not list(Path().glob("*.py"))
