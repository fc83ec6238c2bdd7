"""The guided tour: laid out once, goes on where it stopped, names the effect, and keeps its answer to itself."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import pytest

import hjcamp.commands
import hjcamp.effects
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_checks import check_plant
from hjcamp.plants.pump_joint.tour import samples as samples
from hjcamp.plants.pump_joint.tour.answer import compared, judged
from hjcamp.plants.pump_joint.tour.kinds import Tour, last_sentence
from hjcamp.plants.pump_joint.tour.spindle import FILES, SPINDLE, lay_out
from hjcamp.records.find import group_by_condition, read_logs

if TYPE_CHECKING:
    from conftest import Call

FEW = ("leakage", "pressure_offset", "stribeck_friction")
REAL_LOAD = hjcamp.commands.load
DIAGNOSIS: dict[str, Any] = {"verdict": "effect", "effects": ["leakage"], "candidates": [], "calibration": {}}


class Played:
    """Commands that only note how they were called and leave their answer."""

    def __init__(self) -> None:
        self.calls: list[list[str]] = []
        self.diagnosis = DIAGNOSIS

    def load(self, path: Path) -> Any:
        """Return a stand-in for every command but the tour."""
        if path.stem == "tour":
            return REAL_LOAD(path)

        @click.command(context_settings={"ignore_unknown_options": True})
        @click.argument("words", nargs=-1)
        def command(words: tuple[str, ...]) -> None:
            self.calls.append([path.stem.rstrip("_"), *words])
            answer: dict[str, Any] = self.diagnosis if path.stem == "diagnose" else {}
            if path.stem == "add":
                name = words[words.index("--as") + 1]
                answer = {"model": name, "file": f"conf/model/{name}.yaml"}
                Path("conf/model").mkdir(parents=True, exist_ok=True)
                Path(answer["file"]).write_text("name: it\n")
            Path(words[words.index("--json") + 1]).write_text(json.dumps(answer))

        return command


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Played:
    """Replace the commands that the tour calls."""
    stand_in = Played()
    monkeypatch.setattr(hjcamp.commands, "load", stand_in.load)
    return stand_in


class Terminal(io.StringIO):
    """Somebody at the keyboard."""

    def isatty(self) -> bool:
        """Say so."""
        return True


def test_the_samples_are_small_and_whole() -> None:
    assert samples.SAMPLES.stat().st_size + samples.SEALED.stat().st_size < 2_000_000
    logs = samples.sample_logs()
    assert len(logs) == 24
    assert [len(tests) for tests in group_by_condition(logs.values()).values()] == [3] * 8
    for log in logs.values():
        assert {"time_s", "reference_deg", "arm_deg", "pressure1_mpa", "pump_deg", "command_deg"} <= set(log.columns)
        assert all(np.isfinite(values).all() and len(values) == log.samples for values in log.columns.values())
        assert "leak" not in json.dumps(log.metadata)


def test_the_answer_is_not_read_by_accident() -> None:
    text = samples.SEALED.read_text(encoding="utf-8")
    assert "leak" not in text and "hjcamp tour --open" in text
    hidden = samples.sealed_answer()
    assert hidden["verdict"] == "effect" and hidden["effects"] == ["leakage"]


def test_what_is_packed_is_unpacked(tmp_path: Path) -> None:
    logs = dict(list(samples.sample_logs().items())[:2])
    samples.pack(logs, tmp_path / "packed")
    again = samples.sample_logs(tmp_path / "packed")
    assert list(again) == list(logs)
    for name, log in logs.items():
        assert again[name].metadata == log.metadata
        assert all(np.array_equal(again[name].columns[field], log.columns[field]) for field in log.columns)
    samples.seal({"effects": ["x"]}, tmp_path / "sealed")
    assert samples.sealed_answer(tmp_path / "sealed") == {"effects": ["x"]}


@pytest.mark.study
def test_the_tour_of_another_machine_finds_what_its_program_hides(call: Call) -> None:
    answer = call("tour", "--plant", "--yes")
    assert answer.code == 0, answer.err
    assert "diagnosed   quadratic_drag   right" in answer.out
    before, after, noise_floor = SPINDLE.fall(Tour(Path("tour_plant"), SPINDLE))
    assert after[1] < 1.5 * noise_floor[1] < 10.0 < before[1]
    for page in ("compare", "diagnose", "compare_held_out"):
        assert (Path("tour_plant") / page / "index.html").is_file()


@pytest.mark.study
def test_it_finds_the_effect_and_shows_the_error_fall(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    half = dict(list(samples.sample_logs().items())[:12])
    monkeypatch.setattr(samples, "sample_logs", lambda: half)
    everything = hjcamp.effects.load_effects([])
    monkeypatch.setattr(hjcamp.effects, "load_effects", lambda folders=None: {name: everything[name] for name in FEW})
    answer = call("tour", "--yes")
    assert answer.code == 0, answer.err
    diagnosis, added, compared = (json.loads(Path(f"tour/step_{n}.json").read_text()) for n in (2, 3, 4))
    assert (diagnosis["verdict"], diagnosis["effects"]) == ("effect", ["leakage"])
    assert added["error"]["after"] < 1.3 < added["error"]["before"]
    before, after = (model["score"] for model in compared["models"])
    assert after < 1.3 < before
    assert "diagnosed   leakage   right" in answer.out
    for page in ("compare", "diagnose", "compare_both"):
        file = Path("tour").resolve() / page / "index.html"
        assert file.as_uri() in answer.out and file.is_file()
    first = Path("tour/compare/index.html").read_text(encoding="utf-8")
    assert "Comparison: published<" in first, "step 4 leaves the page of step 1 alone"
    assert "Comparison: published, tour_model<" in Path("tour/compare_both/index.html").read_text(encoding="utf-8")
    model = Path("conf/model/tour_model.yaml")
    assert model.is_file() and f"rm -r tour {model}" in answer.out


def test_the_steps_in_order_then_on_from_where_it_stopped(call: Call, played: Played) -> None:
    assert call("tour", "--step", "1").code == 0
    assert len(list(Path("tour/logs").glob("*.mcap"))) == len(read_logs(["tour"])) == 24
    Path("tour/logs/mixed_pid_r1.mcap").unlink()
    answer = call("tour")
    assert answer.code == 0, answer.err
    assert Path("tour/logs/mixed_pid_r1.mcap").is_file()
    assert "goes on with step 2" in answer.out and "Step 1 of 5" not in answer.out
    assert played.calls == [
        ["compare", "tour", "--model", "published", "--json", "tour/step_1.json"],
        ["diagnose", "tour", "--effort", "quick", "--json", "tour/step_2.json"],
        ["add", "leakage", "tour", "--as", "tour_model", "--json", "tour/step_3.json"],
        [
            *("compare", "tour", "--model", "published", "--model", "tour_model"),
            *("--into", "tour/compare_both", "--json", "tour/step_4.json"),
        ],
    ]
    for words in played.calls[1:]:
        assert f"$ hjcamp {' '.join(words)}" in answer.out
    assert "hidden      leakage" in answer.out
    played.calls.clear()
    assert "goes on with step 5" in call("tour").out
    assert not played.calls


def test_the_tour_of_another_machine_goes_the_same_way(call: Call, played: Played) -> None:
    played.diagnosis = DIAGNOSIS | {"effects": ["quadratic_drag"]}
    assert call("tour", "--plant", "--step", "1").code == 0
    assert Path("plants/spindle.py").read_text() == (FILES / "plant.txt").read_text()
    answer = call("tour", "--plant")
    assert answer.code == 0, answer.err
    assert "goes on with step 2" in answer.out and "diagnosed   quadratic_drag   right" in answer.out
    logs = ["tour_plant/logs/train_1.mcap", "tour_plant/logs/train_2.mcap"]
    first = Path(logs[0])
    first.parent.mkdir()
    first.touch()
    assert call("tour", "--plant", "--step", "3").code == 0 and first.exists()
    # import replaces no log
    assert call("tour", "--plant", "--step", "1").code == 0 and not first.exists()
    del played.calls[-2:]
    assert [words[0] for words in played.calls] == ["import", "compare", "diagnose", "add", "compare"]
    assert played.calls[2] == ["diagnose", *logs, "--effort", "quick", "--json", "tour_plant/step_3.json"]
    assert played.calls[3][:6] == ["add", "quadratic_drag", *logs, "--as", "spindle_model"]
    assert played.calls[4][1] == "tour_plant/logs/held_out.mcap"
    assert not any("held_out" in word for words in played.calls[1:4] for word in words), "it is in no fit"
    assert "rm -r tour_plant conf/model/spindle_model.yaml plants/spindle.py" in answer.out


def test_a_plant_of_the_users_own_is_not_overwritten(call: Call) -> None:
    Path("plants").mkdir()
    Path("plants/spindle.py").write_text("mine")
    answer = call("tour", "--plant")
    assert answer.code == 2 and "another plant" in answer.err and Path("plants/spindle.py").read_text() == "mine"


def test_the_spindle_is_accepted_and_its_recordings_are_those_of_their_program(
    empty_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "docs" / "gallery"))
    import make_logs

    monkeypatch.setattr(make_logs, "TOUR", empty_folder / "tour")
    monkeypatch.setattr(make_logs, "HERE", empty_folder / "gallery")
    make_logs.main()
    committed = Path(__file__).parents[2] / "docs" / "gallery"
    for made, kept in ((empty_folder / "tour", FILES), (empty_folder / "gallery", committed)):
        assert {path.name for path in made.glob("*.csv")} == {path.name for path in kept.glob("*.csv")}
        for path in made.glob("*.csv"):
            assert path.read_bytes() == (kept / path.name).read_bytes(), path.name
    lay_out(Path("tour_plant"))
    check_plant(find_plant("spindle"))
    hidden = samples.sealed_answer(SPINDLE.sealed)
    assert hidden["effects"] == ["quadratic_drag"] and hidden["base"] == make_logs.SPINDLE
    assert "drag" not in SPINDLE.sealed.read_text() + (FILES / "plant.txt").read_text()


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ({"logs": [{"duration_s": 15.0}, {"duration_s": 14.6}]}, "2 logs, 30 s of motion"),
        ({"verdict": "effect", "effects": ["a"], "error": {"baseline": 13.02, "augmented": 0.97}}, "by 13.02 times"),
        ({"helps": False, "effects": ["a", "b"], "error": {"before": 2.0, "after": 2.1}}, "a and b does not help: 2.00 times"),
        (
            {"models": [{"name": "published", "score": 6.14}], "calibrated": {"name": "c", "score": 2.13}},
            "published 6.14, c 2.13.",
        ),
        ({}, ""),
    ],
)
def test_the_last_sentence_of_a_step_is_computed(answer: dict[str, Any], said: str) -> None:
    assert said in last_sentence(answer)


def test_the_picture_at_the_end_is_of_what_was_held_out(call: Call, played: Played) -> None:
    assert call("tour").code == 0
    Path("tour/step_3.json").write_text(
        json.dumps({"model": "m", "file": "m.yaml", "error": {"start": 6.06, "before": 2.04, "after": 1.05, "floor": 1.0}})
    )
    answer = call("tour", "--open")
    assert answer.code == 0, answer.err
    assert "published 6.06, constants estimated 2.04, m 1.05, repeatability 1.00." in " ".join(answer.out.split())
    assert "6.06" in Path("tour/error_falls.svg").read_text(encoding="utf-8")


def test_a_second_tour_takes_another_name(call: Call, played: Played) -> None:
    assert call("tour", "--yes").code == 0
    assert call("tour", "--yes", "--into", "again").code == 0
    assert played.calls[-2][3:5] == ["--as", "tour_model_2"]
    assert played.calls[-1][5] == "tour_model_2"


def test_a_diagnosis_that_does_not_settle(call: Call, played: Played) -> None:
    played.diagnosis = DIAGNOSIS | {"verdict": "one_of", "effects": ["a", "b"]}
    played.diagnosis["candidates"] = [{"effect": "leakage", "parameters": {}}]
    answer = call("tour")
    assert answer.code == 0 and "best candidate is added: leakage" in answer.out
    assert played.calls[2][1] == "leakage" and "not what was hidden" in answer.out
    played.diagnosis = DIAGNOSIS | {"verdict": "nothing_missing", "effects": []}
    answer = call("tour", "--into", "other")
    assert answer.code == 1 and "nothing to add" in answer.err


def test_enter_goes_on_and_q_stops(call: Call, played: Played, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr("sys.stdin", Terminal("\nq\n"))
    assert call("tour").code == 0
    assert [words[0] for words in played.calls] == ["compare", "diagnose"]
    monkeypatch.setattr("sys.stdin", Terminal(""))
    assert call("tour").code == 0
    assert len(played.calls) == 3, "no more keys: as if q were pressed"
    assert call("tour", "--yes").code == 0
    assert len(played.calls) == 4


def test_the_answer_can_be_opened_at_any_time(call: Call) -> None:
    answer = call("tour", "--open")
    assert answer.code == 0 and "hidden      leakage" in answer.out and "nothing yet" in answer.out
    assert not Path("tour").exists()
    answer = call("tour", "--plant", "--open")
    assert answer.code == 0 and "hidden      quadratic_drag" in answer.out and "nothing yet: hjcamp tour --plant" in answer.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--step", "0"], "1 to 5"),
        (["--step", "6"], "1 to 5"),
        (["--effort", "quik"], "did you mean 'quick'"),
        (["--open", "--step", "2"], "one of them"),
        (["--into", "mine"], "other things than this tour"),
        (["--into", "mine/thesis.txt"], "this is a file"),
        (["--step", "4"], "first do step 3"),
        *(
            (["--plant", "--step", step], f"first do step {needed}")
            for step, needed in (("2", 1), ("3", 1), ("4", 3), ("5", 4))
        ),
    ],
)
def test_unusable_calls(call: Call, arguments: list[str], words: str) -> None:
    Path("mine").mkdir()
    Path("mine/thesis.txt").write_text("do not touch")
    answer = call("tour", *arguments)
    assert answer.code == 2 and words in answer.err and answer.err.count("\n") == 1
    assert [path.name for path in Path("mine").iterdir()] == ["thesis.txt"]


def test_a_step_that_fails_ends_the_tour_with_its_code(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def load(path: Path) -> Any:
        @click.command(context_settings={"ignore_unknown_options": True})
        @click.argument("words", nargs=-1)
        def command(words: tuple[str, ...]) -> None:
            raise click.exceptions.Exit(1)

        return REAL_LOAD(path) if path.stem == "tour" else command

    monkeypatch.setattr(hjcamp.commands, "load", load)
    answer = call("tour", "--yes")
    assert answer.code == 1
    assert "Step 2" not in answer.out


def test_a_damaged_answer_is_said(call: Call) -> None:
    Path("tour").mkdir()
    Path("tour/about.txt").write_text(samples.ABOUT)
    Path("tour/step_2.json").write_text("{")
    answer = call("tour", "--open")
    assert answer.code == 1 and "do it again: --step 2" in answer.err


def test_part_of_the_truth_is_part_of_it() -> None:
    hidden = {"verdict": "effect", "effects": ["leakage"]}
    assert judged(hidden, {"verdict": "one_of", "effects": ["leakage", "tubing_creep"]}) == "partly right"


@pytest.mark.parametrize(
    ("value", "interval", "said"),
    [
        (2.5, (1.8, 2.2), "1 of 2 hidden values lie within {}; outside: leakage.x (found 20 % lower)."),
        (1.6, (1.8, 2.2), "1 of 2 hidden values lie within {}; outside: leakage.x (found 25 % higher)."),
        (2.1, (1.8, 2.2), "2 of 2 hidden values lie within {}."),
    ],
)
def test_the_last_sentence_is_computed_from_what_was_found(value: float, interval: tuple[float, float], said: str) -> None:
    row = {"value": 2.0, "unit": "N", "ci95": list(interval), "published": 1.0}
    found = {
        "candidates": [{"effect": "leakage", "parameters": {"x": row}}],
        "calibration": {"mass": row | {"ci95": [1.0, 3.0]}},
    }
    hidden = {"parameters": {"leakage": {"x": value}}, "base": {"mass": 2.9}}
    said = said.format("the 95 % interval of what was found")
    assert compared(hidden, found) == said and compared(hidden, {}) == ""
