"""Run folders: made whole, found again, refused for another configuration, locked."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from hjcamp.campaign.files.dotted_paths import common
from hjcamp.campaign.files.lock import is_locked, run_lock
from hjcamp.campaign.files.run_folder import folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runs.finding import find_runs
from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.plan import Plan
from hjcamp.storage import write_whole


@pytest.fixture(scope="module")
def plan(composer: Composer) -> Plan:
    return make_plan(composer.compose(["repetitions=2"]).config, None, ["repetitions=2"], composer)


def test_a_new_folder_says_what_was_asked(plan: Plan, empty_folder: Path) -> None:
    folder, goes_on = folder_for(plan, {"seed": 1}, ["seed=1"], None)
    assert not goes_on
    assert folder.path.parent == Path("runs/single")
    assert yaml.safe_load((folder.path / "config.yaml").read_text()) == {"overrides": ["seed=1"], "seed": 1}
    assert json.loads((folder.path / "plan.json").read_text())["tests"][0]["log"] == "logs/ramp_pos__pid/rep_01.mcap"
    assert set(json.loads((folder.path / "manifest.json").read_text())["tests"]) == {test.id for test in plan.tests}
    assert not list(folder.path.rglob("*.part"))


def test_the_configuration_says_what_runs_and_not_what_a_campaign_replaces(composer: Composer, empty_folder: Path) -> None:
    lines = ["campaign=robustness_vertical"]
    asked = composer.compose(lines).config
    folder, _ = folder_for(make_plan(asked, "robustness_vertical", lines, composer), asked, lines, None)
    kept = yaml.safe_load((folder.path / "config.yaml").read_text())
    assert asked["orientation"]["name"] == "horizontal"
    assert (kept["orientation"]["name"], kept["payload"]["name"]) == ("vertical", "brass_8p5g")
    assert (kept["trajectory"], kept["controller"]) == ("varies", "varies")
    assert (kept["overrides"], kept["campaign"]["name"]) == (lines, "robustness_vertical")


@pytest.mark.parametrize(
    ("values", "together"),
    [
        ([1, 1], 1),
        ([1, 2], "varies"),
        ([{"a": 1}, {"a": 1, "b": 2}], {"a": 1, "b": "varies"}),
        (
            [{"name": "x", "a": {"p": 1, "q": 1}}, {"name": "x", "a": {"p": 2, "q": 1}}],
            {"name": "x", "a": {"p": "varies", "q": 1}},
        ),
        ([{"name": "x", "a": 1}, {"name": "y", "a": 1}], "varies"),
        ([None, {}], "varies"),
        ([[1, 2], [1, 3]], "varies"),
    ],
)
def test_what_all_have(values: list[Any], together: Any) -> None:
    assert common(values) == together


def test_an_unfinished_run_goes_on(plan: Plan, empty_folder: Path) -> None:
    first, _ = folder_for(plan, {}, [], None)
    first.begin(1)
    first.end("interrupted")
    again, goes_on = folder_for(plan, {}, [], None)
    assert goes_on and again.path == first.path
    first.end("complete")
    new, goes_on = folder_for(plan, {}, [], None)
    assert not goes_on and new.path != first.path


def test_a_run_of_other_code_does_not_go_on_by_itself(plan: Plan, empty_folder: Path) -> None:
    first, _ = folder_for(plan, {}, [], None)
    first.begin(1)
    first.manifest["sessions"][-1]["git"] = "another commit"
    first.end("interrupted")
    assert not folder_for(plan, {}, [], None)[1]


def test_another_configuration_is_refused_and_named(plan: Plan, composer: Composer, empty_folder: Path) -> None:
    folder_for(plan, {}, [], Path("mine"))
    before = (empty_folder / "mine" / "plan.json").read_bytes()
    lines = ["repetitions=2", "controller.positive.kp=2"]
    other = make_plan(composer.compose(lines).config, None, lines, composer)
    with pytest.raises(UsageError, match=r"controller\.positive\.kp: 1\.05 there, 2 here"):
        folder_for(other, {}, [], Path("mine"))
    assert (empty_folder / "mine" / "plan.json").read_bytes() == before
    assert folder_for(replace(plan, description="words"), {}, [], Path("mine"))[1]


def test_what_is_no_run_folder_is_refused(plan: Plan, empty_folder: Path) -> None:
    (empty_folder / "file").touch()
    with pytest.raises(UsageError, match="not a run folder"):
        folder_for(plan, {}, [], Path("file"))
    with pytest.raises(UsageError, match="not found"):
        open_folder(Path("nothing"))
    with pytest.raises(UsageError, match=r"plan\.json is missing"):
        open_folder(empty_folder)


def test_a_manifest_that_is_gone_is_made_anew(plan: Plan, empty_folder: Path) -> None:
    folder, _ = folder_for(plan, {}, [], Path("mine"))
    folder.begin(1)
    (folder.path / "manifest.json").unlink()
    assert open_folder(folder.path).manifest["state"] == "new"


def test_one_process_at_a_time(empty_folder: Path) -> None:
    hold = (
        "import sys; from pathlib import Path; from hjcamp.campaign.files.lock import run_lock\n"
        "with run_lock(Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    )
    root = str(Path(__file__).parents[2])
    with subprocess.Popen(
        [sys.executable, "-c", hold, str(empty_folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=root,
        text=True,
    ) as other:
        assert other.stdout is not None and other.stdout.readline() == "held\n"
        assert is_locked(empty_folder)
        with pytest.raises(UsageError, match=f"another run is at work.*{other.pid}"), run_lock(empty_folder):
            pass
        other.kill()
    assert not is_locked(empty_folder)
    with run_lock(empty_folder):
        pass


LOOKER = """
import sys, time
from pathlib import Path
from hjcamp.campaign.files.lock import is_locked
print("looks", flush=True)
seen = 0
while not Path("enough").exists():
    seen += is_locked(Path(sys.argv[1]))
print(seen)
"""


def test_a_look_does_not_lock(plan: Plan, empty_folder: Path) -> None:
    """Two processes look all the time, as `hjcamp ls` does: every start finds the folder free, and no look a run."""
    folder = folder_for(plan, {}, [], Path("mine"))[0].path
    (folder / ".lock").touch()
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    options: dict[str, Any] = {"stdout": subprocess.PIPE, "text": True, "env": environment}
    lookers = [subprocess.Popen([sys.executable, "-c", LOOKER, str(folder)], **options) for _ in range(2)]
    try:
        for looker in lookers:
            assert looker.stdout.readline() == "looks\n"
        time.sleep(0.3)
        (empty_folder / "enough").touch()
        assert [int(looker.communicate(timeout=60)[0]) for looker in lookers] == [0, 0], "a look took another for a run"
        (empty_folder / "enough").unlink()
        lookers = [subprocess.Popen([sys.executable, "-c", LOOKER, str(folder)], **options) for _ in range(2)]
        for looker in lookers:
            assert looker.stdout.readline() == "looks\n"
        for _ in range(200):
            with run_lock(folder):
                pass
    finally:
        (empty_folder / "enough").touch()
        for looker in lookers:
            looker.communicate(timeout=60)


def test_a_failed_write_leaves_the_old_file(empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = empty_folder / "file"
    write_whole(target, "old")

    def refuse(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", refuse)
    with pytest.raises(OSError, match="No space"):
        write_whole(target, "new")
    assert target.read_text() == "old"
    assert [path.name for path in empty_folder.iterdir()] == ["file"]


def test_a_full_disk_is_said(plan: Plan, empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", refuse)
    with pytest.raises(HjcampError, match="the disk is full"):
        folder_for(plan, {}, [], Path("mine"))
    assert not (empty_folder / "mine" / "plan.json").exists()


def test_runs_are_found_by_what_they_hold(plan: Plan, empty_folder: Path) -> None:
    folder, _ = folder_for(plan, {}, [], None)
    folder.begin(1)
    for filters in (["campaign=single"], ["payload=none"], ["controller.positive.kp=1.05"], ["state=interrupted"]):
        assert [run.path for run in find_runs(filters=filters)] == [folder.path], filters
    for filters in (["payload=brass_8p5g"], ["controller.positive.kp=1"], ["payload=none", "seed=2"]):
        assert find_runs(filters=filters) == [], filters
    with pytest.raises(UsageError, match="KEY=VALUE"):
        find_runs(filters=["payload"])
