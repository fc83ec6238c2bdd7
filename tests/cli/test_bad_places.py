"""Places that take no file, names that are too long, pipes and damaged answers: said at once, and nothing is written."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from hjcamp.errors import HjcampError, UsageError
from hjcamp.plants.pump_joint.tour.samples import ABOUT
from hjcamp.storage import check_place, named_file

if TYPE_CHECKING:
    from conftest import Call

LONG = "x" * 300


def files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


@pytest.mark.parametrize(
    "words",
    [
        ("compare", "logs", "--json", LONG),
        ("compare", "logs", "--into", LONG),
        ("diagnose", "logs", "--json", f"{LONG}/x.json"),
        ("add", "leakage", "logs", "--as", LONG),
        ("next", "logs", "--as", LONG),
        ("next", "logs", "--json", LONG),
        ("calibrate", "logs", "--as", LONG),
        ("tune", "--as", LONG),
        ("effects", "new", LONG),
        ("effects", "leakage", "--figure", f"{LONG}.png"),
        ("plants", "new", LONG),
        ("plants", "pump_joint", "--figure", f"{LONG}.svg"),
        ("import", "table.csv", "--map", "map.yaml", "--output", LONG),
        ("log", "recover", "a.mcap", "--output", LONG),
        ("report", "logs", "--output", LONG),
    ],
)
def test_a_name_that_is_too_long(words: tuple[str, ...], call: Call, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    before = files(tmp_path)
    answer = call(*words)
    assert answer.code == 2 and "letters; at most 200 are allowed" in answer.err, answer.err
    assert len(answer.err) < 300 and files(tmp_path) == before


def test_a_name_that_is_too_long_to_be_read(call: Call) -> None:
    for words in (("compare", LONG), ("show", LONG), ("log", "info", LONG)):
        answer = call(*words)
        assert answer.code == 2 and "too long" in answer.err, answer.err


def test_places(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    check_place(tmp_path / "new" / "deep" / "x.json")
    check_place(tmp_path / "file")
    check_place(tmp_path, folder=True)
    assert files(tmp_path) == ["file", "loop"], "what was tried is taken away"
    for place, folder, told in (
        (tmp_path / "file" / "x", False, "file is no folder"),
        (tmp_path / "loop" / "x", False, "loop"),
        (tmp_path, False, "this is a folder; give a file"),
        (tmp_path / "file", True, "this is a file; give a folder"),
        (Path(""), False, "this is a folder"),
        (Path("/x\0y"), False, "control characters"),
    ):
        with pytest.raises(UsageError, match=told):
            check_place(place, "--json", folder)
    with pytest.raises(HjcampError, match="cannot be written"):
        check_place(Path("/proc/nowhere/x"), "--json")
    for name in ("", "a/b", "..", "a b", "-a", "a\nb"):
        with pytest.raises(UsageError, match="cannot be the name of a model"):
            named_file(name, "model", tmp_path)


@pytest.mark.parametrize("name", ["a.gif", "a", ""])
def test_a_picture_that_is_not_drawn(name: str, call: Call, tmp_path: Path) -> None:
    for words in (("plants", "pump_joint"), ("effects", "leakage")):
        answer = call(*words, "--figure", name)
        assert answer.code == 2 and "the suffix must be one of .pdf, .png, .svg" in answer.err
    assert files(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("map.yaml", ("import", "table.csv", "--map", "map.yaml")),
        ("campaigns/mine.yaml", ("plan", "campaign=mine")),
        ("effects/mine.py", ("effects",)),
        ("plants/mine.py", ("plants", "mine")),
        ("trajectories/mine.py", ("plan",)),
        ("controllers/mine.py", ("plan",)),
    ],
)
def test_a_pipe_in_the_place_of_a_file(name: str, words: tuple[str, ...], call: Call, tmp_path: Path) -> None:
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    os.mkfifo(tmp_path / name)
    answer = call(*words)
    assert answer.code == 2 and f"{name}: cannot be read: this is a pipe" in answer.err


@pytest.mark.parametrize("content", ["null", "[1]", "{}", "{", '{"model": "mine"}', "[" * 100_000])
def test_a_damaged_answer_of_the_tour(content: str, call: Call, tmp_path: Path) -> None:
    (tmp_path / "tour").mkdir()
    (tmp_path / "tour" / "about.txt").write_text(ABOUT)
    (tmp_path / "tour" / "step_3.json").write_text(content)
    for words in (("--step", "4"), ("--open",)):
        answer = call("tour", *words)
        assert answer.code == 1 and "do it again: --step 3" in answer.err, answer.err


@pytest.mark.parametrize("change", [{"calibration": 3}, {"candidates": [1]}, {"effects": None}, {"verdict": []}])
def test_a_damaged_diagnosis_of_the_tour(change: dict[str, object], call: Call, tmp_path: Path) -> None:
    (tmp_path / "tour").mkdir()
    whole = {"verdict": "effect", "effects": ["leakage"], "candidates": [], "calibration": {}}
    (tmp_path / "tour" / "step_2.json").write_text(json.dumps(whole | change))
    answer = call("tour", "--open")
    assert answer.code in (0, 1) and "internal error" not in answer.err


def test_a_step_that_cannot_be_done_yet_writes_nothing(call: Call, tmp_path: Path) -> None:
    answer = call("tour", "--step", "4", "--into", "new")
    assert answer.code == 2 and "first do step 3" in answer.err and files(tmp_path) == []


def test_a_seed_and_a_folder_that_cannot_be(call: Call) -> None:
    for seed in ("-1", "1" * 400):
        answer = call("diagnose", "logs", "--seed", seed)
        assert answer.code == 2 and "0 or more and below 2^63" in answer.err and len(answer.err) < 200
    answer = call("ls", "--folder", "nowhere")
    assert answer.code == 2 and "there is no such folder" in answer.err
    answer = call("next", "logs", "--rivals", ",")
    assert answer.code == 2 and "--rivals names none" in answer.err
