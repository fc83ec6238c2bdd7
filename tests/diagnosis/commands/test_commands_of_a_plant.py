"""The commands on tests of a user's plant: from two CSV files to a model whose error falls on a log that it does not know."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from answer_schemas import check_answer
from typer.testing import CliRunner

from hjcamp.analyses.data import Data
from hjcamp.analyses.diagnosing import Asked, made_from
from hjcamp.cli import app
from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.decision.verdict import ONE_OF, Verdict, decided
from hjcamp.errors import UsageError

SAMPLES = Path(__file__).parents[3] / "docs" / "own_plant"
ONLY = "spring,constant_force,quadratic_drag"  # those of the verdict's tests and of the notebook: one kernel
run = CliRunner().invoke


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the plant and the first half of its measurements, made once by the commands."""
    folder = tmp_path_factory.mktemp("imported")
    files = [str(folder / f"{name}.csv") for name in ("train", "held_out")]
    for file in map(Path, files):
        lines = (SAMPLES / file.name).read_text(encoding="utf-8").splitlines(True)
        file.write_text("".join(lines[: len(lines) // 2]), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert run(app, ["plants", "new", "stage"]).exit_code == 0
        done = run(app, ["import", *files, "--map", str(SAMPLES / "map.yaml"), "--into", "logs"])
    assert done.exit_code == 0, done.output
    return folder


@pytest.fixture
def stage(imported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a copy of that folder."""
    shutil.copytree(imported, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def check_diagnosis_page(folder: Path, answer: dict[str, Any]) -> None:
    """Check the page of a diagnosis that found a spring, and the files next to it."""
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "spring" in page and "<svg" in page and "http://" not in page.replace("http://www.w3.org", "")
    assert page.index('class="evidence"') < page.index("<math") < page.index("Effects, best first")
    assert all(
        said in page for said in ("missing: calibrated model", "missing: with spring", "spring, forwards", "spring, backwards")
    )
    assert all(said in page for said in ("worst test", "these tests", "residual with itself", "with voltage before"))
    known = page[page.index("How well each parameter is known") :]
    assert "spring stiffness" in known and known.count("<svg") == 1
    assert (folder / "corner.svg").is_file()
    assert "Hooke" in (folder / "effect_spring.html").read_text(encoding="utf-8")
    assert json.loads((folder / "answer.json").read_text(encoding="utf-8")) == answer


def check_comparison_page(folder: Path, declared: dict[str, Any], added: dict[str, Any]) -> None:
    """Check the page of a comparison of the declared model with the one that has the spring."""
    page = (folder / "index.html").read_text(encoding="utf-8")
    head = json.loads(page.partition('id="explorer-head">')[2].partition("</script>")[0])
    assert head["models"] == ["published", "with_spring", "with_spring, calibrated here", "with_spring without spring"]
    assert head["hidden"] == ["with_spring without spring"] and head["observed"] == "measured"
    assert [one["name"] for one in head["channels"]] == ["position_m", "voltage_v"]
    [test] = head["tests"]
    assert {one["model"] for one in test["curves"]} == {-1, 0, 1, 2, 3}
    assert [row["position_m"] for row in test["rms"][:2]] == pytest.approx(
        [1e3 * one["error"]["position_m"]["rms"] for one in (declared, added)]  # in the unit of tables, mm
    )
    # without its spring the model is about as wrong as the declared one
    assert test["rms"][3]["position_m"] > 5.0 * test["rms"][1]["position_m"]
    assert "position_m<" not in page


def test_the_tour_of_an_own_plant(stage: Path) -> None:
    done = run(app, ["diagnose", "logs/train.mcap", "--only", ONLY, "--json", "a.json", "--ask", "quadratic_drag"])
    assert done.exit_code == 0, done.output
    answer = json.loads((stage / "a.json").read_text(encoding="utf-8"))
    assert (answer["schema"], answer["plant"]) == ("hjcamp.diagnosis/2", "stage")
    assert (answer["verdict"], answer["effects"]) == ("effect", ["spring"])
    check_diagnosis_page(stage / "diagnose", answer)
    assert any(row["effect"] == "quadratic_drag" and row["asked"] for row in answer["candidates"])
    done = run(app, ["add", "spring", "logs/train.mcap", "--as", "with_spring", "--json", "b.json"])
    assert done.exit_code == 0, done.output
    saved = yaml.safe_load((stage / "conf/model/with_spring.yaml").read_text(encoding="utf-8"))
    # with the spring the carriage needs no form of its contact any more
    assert saved["plant"] == "stage" and set(saved["effects"]) == {"spring"}
    assert "form of its contacts" not in (stage / "conf/model/with_spring.yaml").read_text(encoding="utf-8")
    assert saved["effects"]["spring"]["stiffness"] == pytest.approx(140.0, rel=0.02)
    assert saved["parameters"]["mass"] == pytest.approx(80.0, rel=0.02)
    assert json.loads((stage / "b.json").read_text(encoding="utf-8"))["helps"] is True
    models = ["--model", "published", "--model", "with_spring"]
    done = run(app, ["compare", "logs/held_out.mcap", *models, "--json", "c.json"])
    assert done.exit_code == 0, done.output
    declared, added = json.loads((stage / "c.json").read_text(encoding="utf-8"))["models"]
    assert added["error"]["position_m"]["rms"] < 0.2 * declared["error"]["position_m"]["rms"]
    check_comparison_page(stage / "compare", declared, added)
    again = run(app, ["compare", "logs/train.mcap", "--json", "t.json"])
    assert again.exit_code == 0, again.output
    compared = json.loads((stage / "t.json").read_text(encoding="utf-8"))["calibrated"]["error"]["position_m"]
    diagnosed = answer["channels"]["position_m"]
    # what is calibrated errs by as much in compare as in diagnose: both have the form of the contact
    assert compared["rms"] == pytest.approx(diagnosed["baseline"], rel=0.05)


@pytest.mark.study
def test_a_group_has_its_page_though_the_model_has_one_of_it(stage: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def group(analysis: Analysis, alpha: float, delta: float) -> Verdict:
        found = decided(analysis, alpha, delta)
        sets = (found.effects, ("constant_force",))
        return replace(found, word=ONE_OF, effects=("spring", "constant_force"), confidence_set=sets)

    monkeypatch.setattr("hjcamp.diagnosis.decision.verdict.decided", group)
    done = run(app, ["diagnose", "logs/train.mcap", "--only", ONLY, "--json", "a.json"])
    assert done.exit_code == 0, done.exception
    answer = json.loads((stage / "a.json").read_text(encoding="utf-8"))
    assert (answer["verdict"], answer["effects"]) == ("one_of", ["spring", "constant_force"])
    assert "missing: with spring" in (stage / "diagnose" / "index.html").read_text(encoding="utf-8")


def test_calibrate_saves_the_base_of_any_plant(stage: Path) -> None:
    done = run(app, ["calibrate", "logs/train.mcap", "--as", "mine"])
    assert done.exit_code == 0, done.output
    saved = yaml.safe_load((stage / "conf/model/mine.yaml").read_text(encoding="utf-8"))
    assert set(saved["parameters"]) == {"mass", "coulomb", "viscous", "delay.voltage"} and saved["effects"] == {}
    refused = run(app, ["calibrate", "logs/train.mcap", "--as", "mine"])
    assert isinstance(refused.exception, UsageError) and "mine.yaml exists" in str(refused.exception)


def test_calibrate_names_what_the_tests_cannot_tell_apart(stage: Path) -> None:
    file = stage / "plants" / "stage.py"
    file.write_text(file.read_text().replace('35.0, text="force', '35.0, (1.0, 100.0), base=True, text="force'))
    done = run(app, ["calibrate", "logs/train.mcap", "--as", "both"])
    # every force is in proportion to the gain
    assert " ".join(done.output.split()).count("These tests do not distinguish gain, mass, coulomb and viscous: give one") == 1


@pytest.mark.study
def test_next_takes_the_diagnosis_of_the_same_logs_and_sets_its_group_apart(stage: Path) -> None:
    data, asked = Data(["logs/train.mcap"]), Asked(only=ONLY)
    known = {"spring": {"stiffness": 140.0, "rest_position": 0.02}, "constant_force": {"strength": 4.0}}
    kept = {
        "schema": "hjcamp.diagnosis/2",
        "verdict": "one_of",
        "effects": list(known),
        "unknowns": [],
        "confidence_set": [[name] for name in known],
        "window_samples": 80,
        "made_from": made_from(data, asked),
        "candidates": [
            {"effect": name, "parameters": {key: {"value": value} for key, value in own.items()}} for name, own in known.items()
        ],
    }
    (stage / "diagnose").mkdir()
    (stage / "diagnose" / "answer.json").write_text(json.dumps(kept), encoding="utf-8")
    done = run(app, ["next", "logs/train.mcap", "--json", "n.json", "--tests", "1"])
    assert done.exit_code == 0, done.exception
    answer = json.loads((stage / "n.json").read_text(encoding="utf-8"))
    check_answer(answer)
    assert answer["reused"] == "diagnose/answer.json" and answer["verdict"] == "one_of"
    assert [row["effects"] for row in answer["rivals"]] == [["spring"], ["constant_force"]]
    assert answer["rivals"][0]["parameters"]["spring"]["stiffness"] == pytest.approx(140.0, rel=0.02)
    [first] = answer["tests"]
    assert answer["needed_separation"] <= first["separation"] <= answer["best_separation"]
    assert len(answer["others"]) == 4 and answer["campaign"] is None and "PROPOSED" in done.output
    assert (stage / "next" / "predictions.png").read_bytes().startswith(b"\x89PNG")
    assert "hjcamp diagnose logs/train.mcap NEW_LOGS" in done.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["diagnose", "logs", "--model", "none"], "unknown model 'none'"),
        (["diagnose", "logs", "--only", "sprong"], "spring"),
        (["diagnose", "logs", "--only", "leakage"], "leakage"),
        (["diagnose", "logs", "--ask", "sprong"], "did you mean 'spring'"),
        (["diagnose", "logs", "--ask", " , "], "give the names of effects"),
        (["diagnose", "logs", "--only", "contact_creep"], "leaves no effect to look for; contact_creep is never named"),
        (["diagnose", "logs", "--alpha", "0.6"], "--alpha 0.6: give a number between 0 and 0.5"),
        (["diagnose", "logs", "--alpha", "0"], "--alpha 0: give a number between 0 and 0.5"),
        (["diagnose", "logs", "--delta", "1"], "--delta 1: give a number between 0 and 1"),
        (["add", "spring", "spring", "logs", "--as", "x"], "each effect once"),
        (["add", "sprong", "logs", "--as", "x"], "spring"),
        (["add", "spring", "logs", "--as", "published"], "exists already"),
        (["add", "leakage", "logs", "--as", "x"], "effect leakage: needs a store"),
        (["calibrate", "logs", "--as", "x", "--only", "pump=pump1"], "name the logs themselves"),
        (["compare", "logs", "--model", "other"], "plant pump_joint"),
        (["compare", "logs", "--model", "broken"], "mass"),
        (["next", "logs", "--rivals", "sprong"], "did you mean 'spring'"),
        (["next", "logs", "--rivals", "spring,spring"], "name each rival once"),
        (["next", "logs", "payload=none"], "made from its logs"),
        (["next", "logs", "--model", "broken"], "mass"),
        (["next", "logs", "--as", "controllers"], "exists already"),
    ],
)
def test_what_is_refused_says_why(stage: Path, words: list[str], said: str) -> None:
    folder = stage / "conf" / "model"
    folder.mkdir(parents=True)
    (folder / "other.yaml").write_text("name: other\nparameters: {}\neffects: {}\n", encoding="utf-8")
    (folder / "broken.yaml").write_text("plant: stage\nparameters: {mass: -3}\neffects: {}\n", encoding="utf-8")
    done = run(app, words)
    assert isinstance(done.exception, UsageError), done.output
    assert said in str(done.exception)
