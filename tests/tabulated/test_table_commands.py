"""The commands on tables: what they refuse, and the model that `add` makes of a diagnosis."""

import json

import pytest
import yaml

from hjcamp.cli import run
from hjcamp.plants.pump_joint.answers.tables import folder_of
from hjcamp.plants.pump_joint.configuration import check_model
from hjcamp.plants.pump_joint.tables import comparison
from hjcamp.plants.pump_joint.tables.answer import SCHEMA
from hjcamp.plants.pump_joint.tables.page import page

FOUND = {
    "schema": SCHEMA,
    "command": "hjcamp diagnose --tables 5.4.1",
    "tables": ["5.4.1"],
    "held_out": [],
    "verdict": "effect",
    "effects": ["controller_scale"],
    "p_value": 0.001,
    "p_left": 0.4,
    "lacking": [],
    "table_sha256": "0" * 64,
    "models": {
        "published": {"names": [], "quantities": {}, "settings": {"parameters": {}, "effects": {}, "factors": {}}},
        "accepted": {
            "names": ["controller_scale", "leakage"],
            "quantities": {},
            "settings": {
                "parameters": {"coulomb_positive": 4.0},
                "effects": {"leakage": {"conductance": 1e-15}},
                "factors": {"controller_scale": 1.3},
            },
        },
    },
    "error": {"accepted": {"mean_abs_log_ratio": {"5.4.1": 0.15}}},
    "error_held_out": {},
}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["diagnose"], "--tables"),
        (["compare"], "--tables"),
        (["diagnose", "--tables", "5.4.11"], "did you mean '5.4.1'"),
        (["compare", "--tables", "5.6.2"], "5.4.1"),
        (["diagnose", "--tables", "5.4.1", "--workers", "0"], "--workers 0"),
        (["diagnose", "--tables", "5.4.1", "--effort", "quik"], "did you mean 'quick'"),
        (["diagnose", "--tables", "5.4.1", "--model", "other"], "--model other"),
        (["diagnose", "run", "--held-out", "5.5.1"], "--held-out 5.5.1"),
        (["diagnose", "--tables", "nothing.csv"], "cannot be read"),
    ],
)
def test_calls_that_cannot_be_are_refused_in_one_message(empty_folder, capsys, words, said):
    assert run(words) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert said in told and "Traceback" not in told


def test_add_saves_the_model_of_a_diagnosis_with_where_it_comes_from(empty_folder, capsys):
    folder = empty_folder / "found"
    folder.mkdir()
    (folder / "diagnosis.json").write_text(json.dumps(FOUND), encoding="utf-8")
    assert run(["add", str(folder), "--as", "mended"]) == 0
    assert "hjcamp compare --tables 5.4.1 --model published --model mended" in capsys.readouterr().out
    made = yaml.safe_load((empty_folder / "conf" / "model" / "mended.yaml").read_text(encoding="utf-8"))
    check_model(made, "model")
    assert made["factors"] == {"controller_scale": 1.3} and made["effects"] == {"leakage": {"conductance": 1e-15}}
    assert made["provenance"]["tables"] == ["5.4.1"]
    assert made["provenance"]["mean_abs_log_ratio"] == {"error": {"5.4.1": 0.15}}
    assert run(["add", str(folder), "--as", "mended"]) == 2


def test_add_refuses_what_is_no_diagnosis_of_a_table_and_one_that_cannot_tell(empty_folder):
    path = empty_folder / "found.json"
    path.write_text("{}", encoding="utf-8")
    assert run(["add", str(path), "--as", "mended"]) == 2
    path.write_text(json.dumps({**FOUND, "verdict": "cannot_tell"}), encoding="utf-8")
    assert run(["add", str(path), "--as", "mended"]) == 2
    assert not (empty_folder / "conf" / "model" / "mended.yaml").exists()


def test_each_call_has_a_folder_of_its_own():
    calls = [
        (["5.4.1", "5.4.2"],), (["mine.csv"],), (["a/mine.csv"],), (["b/mine.csv"],), (["mine.csv"], (None, None, "5.5.1")),
        (["mine.csv"], (None, None, None, "payload=brass_8p5g")), (["mine.csv"], ("leakage", None, None)),
    ]  # fmt: skip
    folders = [folder_of(tables, "quick", 1, *others) for tables, *others in calls]
    assert len(set(folders)) == len(calls)
    assert [one.name for one in folders[:2]] == ["tables_5.4.1_5.4.2_quick_1", "tables_mine_quick_1"]
    assert folder_of(["mine.csv"], "quick", 1, (None, None, None)) == folders[1]


def test_a_model_on_the_table_it_was_fitted_to_is_no_prediction(empty_folder, capsys, monkeypatch):
    error = {"mean_abs_log_ratio": {"5.4.1": 0.2}, "near": 40, "cells": 42, "loss": 50.0}
    content = {
        "schema": "hjcamp.table_comparison/1",
        "tables": ["5.4.1"],
        "error_held_out": {},
        "cells": [],
        "models": {"published": {}, "refit": {"tables": ["5.4.1", "5.4.2"]}},
        "error": {"published": error, "refit": error},
    }
    monkeypatch.setattr(comparison, "compare", lambda *given: content)
    assert run(["compare", "--tables", "5.4.1", "--model", "published", "--model", "refit"]) == 0
    out = capsys.readouterr().out
    assert "refit was fitted to 5.4.1: its error there is no prediction" in out and "published was fitted" not in out


def test_add_says_that_a_folder_is_not_there(empty_folder, capsys):
    assert run(["add", "runs/nowhere", "--as", "mended"]) == 2
    err = capsys.readouterr().err
    assert "runs/nowhere: does not exist" in err and len(err.strip().splitlines()) == 1


def test_a_page_of_cells_that_cannot_tell_says_why_and_nothing_more():
    told = page({**FOUND, "verdict": "cannot_tell", "effects": [], "lacking": ["2 conditions; 3 at least are needed"]})
    assert "2 conditions; 3 at least are needed" in told and "##" not in told
