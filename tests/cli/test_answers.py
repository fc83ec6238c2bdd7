"""--json of every command: one option with one meaning, an answer that meets its schema, targets that are no file."""

from __future__ import annotations

import json
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from answer_schemas import SCHEMAS, check_answer, validator

from hjcamp.commands import command_files, load

if TYPE_CHECKING:
    from conftest import Call

#: They act, and say on the way how it goes, or where a page is, or print JSON themselves: nothing is asked of them.
SILENT = {"open", "repository", "resume", "rig serve", "run", "schema", "share", "tour"}
HELP = "Write the answer for programs to this file; - is standard output."


def commands() -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, path in command_files().items():
        command = load(path)
        parts = getattr(command, "commands", None)
        found |= {f"{name} {part}": one for part, one in parts.items()} if parts else {name: command}
    return {name: one for name, one in found.items() if name not in SILENT}


def test_every_command_that_answers_has_the_same_option() -> None:
    for name, command in commands().items():
        option = next((one for one in command.params if "--json" in one.opts), None)
        assert option is not None, f"hjcamp {name} has no --json"
        assert option.help == HELP and not option.is_flag and option.default is None, name


def test_schemas_are_schemas_and_all_are_listed() -> None:
    page = (SCHEMAS / "README.md").read_text(encoding="utf-8")
    files = sorted(SCHEMAS.glob("*.json"))
    for file in files:
        content = json.loads(file.read_text(encoding="utf-8"))
        validator(content["title"]).check_schema(content)
        assert content["properties"]["schema"] == {"enum": [content["title"]]} and f"({file.name})" in page
        assert file.stem == content["title"].replace("/", "-")
    assert page.count(".json)") == len(files)


@pytest.fixture
def one_run(call: Call) -> None:
    answer = call("run", "trajectory=mixed", "repetitions=2", "run_dir=runs/mine/1")
    assert answer.code == 0, answer.err


def test_real_answers_meet_their_schemas(call: Call, one_run: None, tmp_path: Path) -> None:
    rows = [f"{k / 1000},{k / 20},{0.3 + k % 7 / 1000},{0.3 + k % 5 / 1000},{k / 20}" for k in range(600)]
    (tmp_path / "table.csv").write_text("\n".join(["t,q,p1,p2,u", *rows, ""]))
    (tmp_path / "map.yaml").write_text(
        "fields: {time_s: t, arm_deg: q, pressure1_mpa: p1, pressure2_mpa: p2, pump_deg: u}\n"
        "metadata: {condition: one, pump: pump2, amplifier: high_gain, tubing: ldpe_300mm}\n"
    )
    calls = {
        "hjcamp.plan/1": ["plan", "campaign=robustness_vertical"],
        "hjcamp.runs/1": ["ls", "--columns", "+rmse1_deg,git", "--sort", "-rmse1_deg"],
        "hjcamp.run/1": ["show", "runs/mine/1"],
        "hjcamp.history/1": ["history", "campaign=single", "--over", "runs"],
        "hjcamp.effects/1": ["effects"],
        "hjcamp.effect/1": ["effects", "leakage", "--no-figure"],
        "hjcamp.plants/1": ["plants"],
        "hjcamp.plant/1": ["plants", "valve_joint"],
        "hjcamp.template/1": ["plants", "new", "mine"],
        "hjcamp.doctor/1": ["doctor"],
        "hjcamp.logs/1": ["log", "info", "runs/mine/1"],
        "hjcamp.recovery/1": ["log", "recover", "runs/mine/1/logs/mixed__pid/rep_01.mcap", "--output", "again.mcap"],
        "hjcamp.rigs/1": ["rig", "unlock"],
        "hjcamp.import/1": ["import", "table.csv", "--map", "map.yaml"],
        "hjcamp.sizing/1": ["sizing"],
        "hjcamp.capability/1": ["sizing", "capability", "torque_mnm=20", "range_deg=180", "diameter_mm=15"],
    }
    for schema, words in calls.items():
        answer = call(*words, "--json", "-")
        assert answer.code == 0, (words, answer.err)
        content = json.loads(answer.out)
        assert content["schema"] == schema, words
        check_answer(content)
    assert [row["run"] for row in json.loads(call("ls", "--json", "-").out)["runs"]] == ["runs/mine/1"]


def test_a_schema_refuses_what_it_does_not_say() -> None:
    with pytest.raises(AssertionError, match="'runs' is a required property"):
        check_answer({"schema": "hjcamp.runs/1", "columns": []})
    with pytest.raises(AssertionError, match=r"columns\[0\]"):
        check_answer({"schema": "hjcamp.runs/1", "columns": [1], "runs": []})
    with pytest.raises(AssertionError, match="has no schema"):
        check_answer({"schema": "hjcamp.nothing/1"})


def test_a_target_that_is_no_file_is_one_message(call: Call, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "there").write_text("precious")
    (tmp_path / "link").symlink_to("there")
    (tmp_path / "hanging").symlink_to("nowhere")
    wrong = {
        "folder": "a folder",
        "link": "a link",
        "hanging": "a link",
        "/dev/null": "a device",
        "/dev/full": "a device",
    }
    for target, kind in wrong.items():
        for words in (["plants"], ["ls"], ["diagnose", "nowhere"]):
            answer = call(*words, "--json", target)
            said = f"hjcamp: --json {target}: this is {kind}; give a file, or - for standard output\n"
            assert (answer.code, answer.out, answer.err) == (2, "", said)
    answer = call("plan", "--json", "--cfg")
    assert answer.code == 2 and answer.err.count("\n") == 1
    assert (tmp_path / "there").read_text() == "precious" and not (tmp_path / "nowhere").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "hanging", "link", "there"]


def test_a_pipe_takes_the_answer(call: Call, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append((tmp_path / "pipe").read_text()), daemon=True)
    reader.start()
    assert call("ls", "--json", "pipe").code == 0
    reader.join(10.0)
    assert json.loads(read[0]) == {
        "schema": "hjcamp.runs/1",
        "columns": ["run", "campaign", "state", "tests", "started"],
        "runs": [],
    }
