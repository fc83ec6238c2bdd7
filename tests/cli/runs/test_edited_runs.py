"""A run folder that somebody edited, cut or filled with other logs: one clear message, and nothing is mixed or written."""

from __future__ import annotations

import contextlib
import copy
import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hjcamp.backends
from hjcamp import cli
from hjcamp.campaign.files.run_folder import open_folder
from hjcamp.campaign.plan.planning import check_plan
from hjcamp.campaign.runs.finding import find_runs
from hjcamp.errors import UsageError
from hjcamp.records.plan import config_sha256, plan_sha256, read_plan

if TYPE_CHECKING:
    from conftest import Call

RUN = Path("runs/one")
READERS = ("resume", "show", "report")


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, quick: Callable[..., Any]) -> Path:
    """Return a folder with two finished runs of two repetitions, of two gains."""
    folder = tmp_path_factory.mktemp("finished")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.delenv("HJCAMP_CONF", raising=False)
        patch.setattr(hjcamp.backends, "run_test", quick)
        for name, gain in (("one", "1.05"), ("two", "3.0")):
            words = ["run", "repetitions=2", "workers=1", f"controller.positive.kp={gain}"]
            assert cli.run([*words, f"run_dir=runs/{name}"]) == 0
    return folder


@pytest.fixture
def run(call: Call, finished: Path) -> Path:
    """Return a finished run in an empty folder."""
    shutil.copytree(finished / RUN, RUN)
    return RUN


def contents(folder: Path) -> dict[str, str]:
    return {
        str(path): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def edit(file: Path, change: Callable[[dict[str, Any]], object]) -> None:
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))


def sign(plan: dict[str, Any]) -> None:
    """Make the hashes of an edited plan right, as somebody would who means harm."""
    for one in plan["conditions"]:
        one["sha256"] = config_sha256(one["config"])
    conditions = [type("Condition", (), one) for one in plan["conditions"]]
    plan["sha256"] = plan_sha256(plan["campaign"], plan["tables"], plan["repetitions"], plan["seed"], conditions)  # type: ignore[arg-type]


@pytest.mark.parametrize("log", ["../../precious.txt", "{here}/precious.txt"])
def test_a_path_in_the_plan_leads_nowhere_else(call: Call, run: Path, log: str) -> None:
    Path("precious.txt").write_text("mine")
    edit(run / "plan.json", lambda plan: plan["tests"][0].update(log=log.format(here=os.getcwd())))
    before = contents(Path())
    answer = call("resume", str(run))
    assert answer.code == 2
    assert "tests[0].log is" in answer.err and "the plan gives 'logs/ramp_pos__pid/rep_01.mcap'" in answer.err
    assert contents(Path()) == before


def test_a_name_in_the_plan_leads_nowhere_else(call: Call, run: Path) -> None:
    def rename(plan: dict[str, Any]) -> None:
        text = json.dumps(plan).replace("ramp_pos__pid", "../../elsewhere")
        plan.clear()
        plan.update(json.loads(text))
        sign(plan)

    edit(run / "plan.json", rename)
    answer = call("resume", str(run))
    assert answer.code == 2 and "conditions[0].name is '../../elsewhere'" in answer.err
    assert not Path("elsewhere").exists() and not Path("runs/elsewhere").exists()


@pytest.mark.parametrize("name", ["logs/ramp_pos__pid", "tables", ".lock", "manifest.json.part", "report.html"])
def test_a_link_in_the_folder_leads_nowhere_else(call: Call, run: Path, name: str) -> None:
    outside = Path("precious")
    (outside / "folder").mkdir(parents=True)
    (outside / "file").write_text("mine")
    place = run / name
    is_folder = place.is_dir()
    shutil.rmtree(place) if is_folder else place.unlink(missing_ok=True)
    place.symlink_to((outside / ("folder" if is_folder else "file")).resolve())
    before = contents(outside)
    for command in ("resume", "report"):
        answer = call(command, str(run))
        assert answer.code == 2 and f"{name} is a link that leads out of the run folder" in answer.err, command
    assert contents(outside) == before


WRITERS = {
    "compare": ("compare", "compare {run}"),
    "diagnose": ("diagnose", "diagnose {run}"),
    "next": ("next", "next {run}"),
    "repetition_1": ("repetition_1", "report {run} --repetition 1"),
    "export": ("", "log export {run}"),
    "view": ("", "log view {run} --with plotjuggler --no-open"),
}


@pytest.mark.parametrize("kind", ["folder", "file in it", "dangling", "part", "folder in it"])
@pytest.mark.parametrize("name", WRITERS)
def test_no_output_beside_logs_goes_through_a_link(call: Call, run: Path, name: str, kind: str) -> None:
    outside = Path("precious")
    outside.mkdir()
    (outside / "file").write_text("mine")
    folder, command = WRITERS[name]
    place = run / folder if folder else Path(name)
    if kind == "folder":
        place.symlink_to(outside.resolve())
    else:
        place.mkdir()
        inside = {"part": "index.html.part", "folder in it": "tables"}.get(kind, "index.html")
        to = {"dangling": outside / "new", "folder in it": outside}.get(kind, outside / "file")
        (place / inside).symlink_to(to.resolve())
    before = contents(outside)
    answer = call(*command.format(run=run).split())
    assert answer.code == 2 and "is a link" in answer.err and str(place) in answer.err
    assert contents(outside) == before


@pytest.mark.parametrize("name", ["report.html", "metrics.json", "tables/indicators.csv", "report.html.part"])
def test_a_report_of_logs_goes_through_no_link(call: Call, run: Path, name: str) -> None:
    logs = Path("received")
    shutil.copytree(run / "logs", logs)
    Path("precious").mkdir()
    Path("precious/file").write_text("mine")
    (logs / name).parent.mkdir(exist_ok=True)
    (logs / name).symlink_to(Path("precious/file").resolve())
    answer = call("report", str(logs))
    if not name.endswith(".part"):
        assert answer.code == 2 and f"{name} is a link" in answer.err
    assert contents(Path("precious")) == {"precious/file": hashlib.sha256(b"mine").hexdigest()}


def test_an_edited_gain_is_not_run(call: Call, run: Path) -> None:
    edit(run / "plan.json", lambda plan: plan["conditions"][0]["config"]["controller"]["positive"].update(kp=5.0))
    (run / "logs/ramp_pos__pid/rep_01.mcap").unlink()
    before = contents(run)
    for command in READERS:
        answer = call(command, str(run))
        assert answer.code == 2, command
        assert "condition 'ramp_pos__pid' was changed after it was planned" in answer.err
    assert contents(run) == before


@pytest.mark.parametrize("key", ["seed", "repetitions", "campaign", "tables"])
def test_what_belongs_to_the_whole_plan_is_hashed(call: Call, run: Path, key: str) -> None:
    values = {"seed": 2, "repetitions": 3, "campaign": "other", "tables": ["table_5_4_1"]}
    edit(run / "plan.json", lambda plan: plan.update({key: values[key]}))
    answer = call("resume", str(run))
    assert answer.code == 2 and "were changed after they were planned" in answer.err


def test_a_log_of_another_test_is_repeated(call: Call, run: Path) -> None:
    logs = run / "logs/ramp_pos__pid"
    good = contents(logs)
    shutil.copy(logs / "rep_02.mcap", logs / "rep_01.mcap")
    answer = call("report", str(run))
    assert answer.code == 0
    assert "rep_01.mcap is left out: repetition 2, planned 1; seed" in answer.err
    page = (run / "report.html").read_text(encoding="utf-8")
    assert "1 log left out, see below" in page
    assert '<td>left out</td><td class="fact">logs/ramp_pos__pid/rep_01.mcap is left out: repetition 2' in page
    assert pl.read_csv(run / "tables/indicators.csv")["repetition"].to_list() == [2]
    for number in (1, 2):
        answer = call("resume", str(run))
        assert answer.code == 0
        assert ("rep_01.mcap is foreign (repetition 2, planned 1" in " ".join(answer.out.split())) == (number == 1)
    assert contents(logs).items() >= good.items()
    assert (logs / "rep_01.mcap.foreign").exists()
    shutil.copy(logs / "rep_02.mcap", logs / "rep_01.mcap")
    assert call("resume", str(run)).code == 0
    assert (logs / "rep_01.mcap.foreign_2").exists(), "what was put aside before stays"


@pytest.mark.study
def test_a_log_of_another_gain_is_not_averaged_in(call: Call, run: Path, finished: Path) -> None:
    two = finished / "runs/two"
    log = "logs/ramp_pos__pid/rep_01.mcap"
    shutil.copy(two / log, run / log)
    answer = call("report", str(run))
    assert answer.code == 0 and "rep_01.mcap is left out: config_sha256" in answer.err
    assert pl.read_csv(run / "tables/indicators.csv").height == 1
    assert "is left out: config_sha256" in call("compare", str(run)).err
    shutil.rmtree(run / "logs/ramp_pos__pid")
    shutil.copytree(two / "logs/ramp_pos__pid", run / "logs/ramp_pos__pid")
    answer = call("report", str(run))
    assert answer.code == 2 and "no log is a test of the plan" in answer.err


def test_a_second_log_of_a_test_does_not_count_twice(call: Call, run: Path) -> None:
    logs = run / "logs/ramp_pos__pid"
    shutil.copy(logs / "rep_02.mcap", logs / "rep_02.recovered.mcap")
    assert "rep_02.recovered.mcap is left out: a second log of ramp_pos__pid/rep_02" in call("report", str(run)).err
    (logs / "rep_02.mcap").unlink()
    answer = call("report", str(run))
    assert "left out" not in answer.err, "a log that was recovered stands for its test"
    assert pl.read_csv(run / "tables/indicators.csv").height == 2


def drop_half(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


FILES: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "tests 5": ("manifest.json", lambda f: edit(f, lambda m: m.update(tests=5)), "tests is 5; an object is needed"),
    "no sessions": ("manifest.json", lambda f: edit(f, lambda m: m.pop("sessions")), "sessions is missing"),
    "a session without start": (
        "manifest.json",
        lambda f: edit(f, lambda m: m["sessions"][0].pop("started_at")),
        "sessions[0].started_at is missing",
    ),
    "another test": ("manifest.json", lambda f: edit(f, lambda m: m["tests"].popitem()), "tests are not those of"),
    "another plan": ("manifest.json", lambda f: edit(f, lambda m: m.update(plan_sha256="0")), "plan_sha256 is not"),
    "a cut manifest": ("manifest.json", drop_half, "manifest.json: this is not JSON"),
    "no conditions": ("plan.json", lambda f: edit(f, lambda p: p.update(conditions=[])), "conditions is empty"),
    "no tests": ("plan.json", lambda f: edit(f, lambda p: p.update(tests=[])), "tests holds 0; 1 condition with 2"),
    "a seed x": ("plan.json", lambda f: edit(f, lambda p: p.update(seed="x")), "seed is 'x'; a valid integer is"),
    "a test's seed x": (
        "plan.json",
        lambda f: edit(f, lambda p: p["tests"][1].update(seed="x")),
        "tests[1].seed is 'x'; a valid integer is",
    ),
    "no controller": (
        "plan.json",
        lambda f: edit(
            f,
            lambda p: (p["conditions"][0]["config"].pop("controller"), sign(p), (f.parent / "manifest.json").unlink()),
        ),
        "the group 'controller' is missing",
    ),
    "no seed": ("plan.json", lambda f: edit(f, lambda p: p.pop("seed")), "seed is missing"),
    "a list": ("plan.json", lambda f: f.write_text("[1]"), "an object {...} is needed"),
    "empty": ("plan.json", lambda f: f.write_text(""), "plan.json: this is not JSON"),
    "cut": ("plan.json", drop_half, "plan.json: this is not JSON"),
    "not UTF-8": ("plan.json", lambda f: f.write_bytes(f.read_text().encode("utf-16")), "this is not JSON"),
    "another version": (
        "plan.json",
        lambda f: edit(f, lambda p: p.update(schema="hjcamp.plan/9")),
        "schema is 'hjcamp.plan/9'; this version reads hjcamp.plan/1",
    ),
    "a folder": ("plan.json", lambda f: (f.unlink(), f.mkdir()), "plan.json is missing"),
}


@pytest.mark.parametrize("case", FILES)
def test_each_fault_has_one_message_and_changes_nothing(call: Call, run: Path, case: str) -> None:
    name, damage, message = FILES[case]
    damage(run / name)
    before = contents(run)
    answer = call("resume", str(run))
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err and len(answer.err.splitlines()) == 1
    assert contents(run) == before


def test_ls_shows_the_other_runs(call: Call, run: Path, finished: Path) -> None:
    shutil.copytree(finished / "runs/two", "runs/two")
    edit(run / "plan.json", lambda plan: plan.update(tests=[]))
    answer = call("ls")
    assert answer.code == 0
    assert "runs/two" in answer.out and "runs/one" not in answer.out
    assert "runs/one/plan.json: tests holds 0" in answer.err


JUNK = st.sampled_from([None, True, -1, 5, 1e300, "x", "../..", "", [], {}, [[]], {"a": 1}, "9" * 400])


@st.composite
def damaged(draw: st.DrawFn, good: bytes) -> bytes:
    """Return a JSON file of which something was deleted, replaced or cut off."""
    if draw(st.integers(0, 5)) == 0:
        return good[: draw(st.integers(0, len(good) - 1))]
    content = json.loads(good)
    for _ in range(draw(st.integers(1, 3))):
        place = content
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = draw(st.sampled_from(keys))
            if isinstance(place[key], dict | list) and place[key] and draw(st.integers(0, 3)):
                place = place[key]
                continue
            if draw(st.booleans()):
                del place[key]
            else:
                place[key] = copy.deepcopy(draw(JUNK))
            break
    return json.dumps(content).encode()


def sound(answer: Any) -> None:
    assert answer.code in (0, 2), answer.err
    assert "internal error" not in answer.err and "Traceback" not in answer.err
    assert (answer.code == 2) == bool(answer.err and answer.out == "") or answer.code == 0


@pytest.mark.parametrize("name", ["plan.json", "manifest.json"])
def test_no_damage_is_an_internal_error(call: Call, run: Path, name: str) -> None:
    good = {file: (run / file).read_bytes() for file in ("plan.json", "manifest.json")}

    @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
    @given(damaged(good[name]))
    def check(content: bytes) -> None:
        for file, whole in good.items():
            (run / file).write_bytes(whole)
        (run / name).write_bytes(content)
        before = contents(run)
        for command in (["show", str(run)], ["ls"], ["report", str(run)], ["resume", str(run)]):
            answer = call(*command)
            sound(answer)
            if answer.code == 2:
                assert contents(run) == before, command
            before = contents(run)

    check()


@pytest.mark.parametrize("signed", [False, True])
def test_many_damaged_plans_are_read(call: Call, run: Path, signed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    run = run.absolute()
    monkeypatch.undo()
    good = (run / "plan.json").read_bytes()
    other = run.parent / "other"
    other.mkdir()

    @settings(max_examples=400, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
    @given(damaged(good))
    def check(content: bytes) -> None:
        if signed:
            with contextlib.suppress(Exception):
                plan = json.loads(content)
                sign(plan)
                content = json.dumps(plan).encode()
        (other / "plan.json").write_bytes(content)
        with contextlib.suppress(UsageError):
            check_plan(open_folder(other).plan, "here")
        assert len(find_runs([other], say=lambda text: None)) <= 1

    check()
    (other / "plan.json").write_bytes(good)
    assert read_plan(other / "plan.json").repetitions == 2
