"""``hjcamp run``, ``plan``, ``ls``, ``show``, ``resume``, ``report`` from call to files and exit codes."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hydra._internal.hydra import Hydra

if TYPE_CHECKING:
    from conftest import Call

SMALL = ["campaign=robustness_vertical", "trajectory=sine_0p5hz", "repetitions=2", "workers=1"]


def written(folder: Path) -> list[str]:
    """Return every file and folder below ``folder``."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["campaign=robustnes_vertical"], "did you mean 'robustness_vertical'"),
        (["campaign=controllers", "controller=pidd"], "unknown controller 'pidd'"),
        (["campaign=controllers", "trajectory=mixedd"], "did you mean 'mixed'"),
        (["campaign=controllers", "controller.positive.kpp=1"], "unknown parameter 'kpp'"),
        (["campaign=controllers", "controller.positive.kp=nan"], "a number from 0 to 1000 is needed"),
        (["campaign=controllers", "repetitions=0"], "repetitions is 0"),
        (["campaign=controllers", "repetitions=-3"], "repetitions is -3"),
        (["trajectory=ramp", "trajectory.duration=-1"], "trajectory.duration"),
        (["joint.moving_mass_g=-18"], "joint.moving_mass_g"),
        (["tubing.stiffness_mpa_per_mm3=0"], "tubing.stiffness_mpa_per_mm3"),
        (["pump=pump1", "amplifier=high_gain"], "Allowed: low_gain"),
        (["campaign=null"], "campaign=null"),
        (["workers=0"], "workers is 0"),
        (["--no-such-flag"], "--no-such-flag"),
        (["campaign=controllers", "controler=pid"], "did you mean 'controller'"),
        (["-m", "campaign=controllers", "repetitions=0,1"], "repetitions is 0"),
        (["-m", "campaign=controllers", "amplifier=low_gain,middle_gain"], "unknown amplifier 'middle_gain'"),
        (["-m", "seed=1,2", "controller.positive.kp=inf"], "controller.positive.kp is inf"),
    ],
)
def test_bad_input_is_one_message_and_nothing_is_written(call: Call, tmp_path: Path, arguments: list[str], words: str) -> None:
    code, out, err = call("run", *arguments)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert out == ""
    assert written(tmp_path) == []


def test_hydra_does_not_compose_to_find_the_mode(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    compose = Hydra.compose_config

    def counted(self: Hydra, *given: Any, **named: Any) -> Any:
        asked.append(named["run_mode"].name)
        return compose(self, *given, **named)

    monkeypatch.setattr(Hydra, "compose_config", counted)
    code, _, err = call("run", "repetitions=0")
    assert code == 2 and "repetitions is 0" in err
    assert asked == ["RUN"]


@pytest.mark.parametrize("command", ["run", "plan"])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hydra.mode=MULTIRUN"], "say -m for a sweep"),
        (["-m", "hydra.mode=RUN", "seed=1,2"], "say -m for a sweep"),
        (["-m", "hydra.sweeper.params.seed=1,2"], "give what varies by itself, such as seed=1,2"),
        (["-m", "+hydra.sweeper.params.seed=5"], "give what varies by itself"),
        (["-m", "payload=glob(nothing*)"], "nothing matches; allowed: brass_8p5g, none"),
        (["-m", "payload=glob(*,exclude=*)"], "nothing matches"),
        (["-m", "seed=glob(*)"], "'seed' is no group of choices"),
    ],
)
def test_a_sweep_that_plan_and_run_would_read_differently_is_refused(
    call: Call, command: str, words: list[str], said: str, tmp_path: Path
) -> None:
    code, out, err = call(command, *words, "campaign=controllers")
    assert (code, out, written(tmp_path)) == (2, "", [])
    assert said in err and err.count("\n") == 1


@pytest.mark.parametrize(
    ("asked", "chosen"),
    [
        ("glob(*)", ["brass_8p5g", "none"]),
        ("glob(brass*)", ["brass_8p5g"]),
        ("glob(*,exclude=none)", ["brass_8p5g"]),
        ("glob([none,br*])", ["brass_8p5g", "none"]),
    ],
)
def test_a_glob_is_a_job_for_each_choice_that_matches(call: Call, asked: str, chosen: list[str]) -> None:
    code, out, err = call("plan", "-m", "campaign=controllers", f"payload={asked}")
    assert (code, err) == (0, "")
    assert [word for word in out.split() if word.startswith("payload=") and word != f"payload={asked}"][: len(chosen)] == [
        f"payload={one}" for one in chosen
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name: mine\nvary: {}\n", "varies nothing"),
        ("name: mine\n", "varies nothing"),
        ("name: mine\nvary: {controller: [pid, pid]}\n", "the same thing twice"),
        ("name: mine\nfixed: {controller: pid}\nvary: {controller: [pid, ffwd_pid]}\n", "sets 'controller' twice"),
        ("name: mine\nvary: {controler: [pid, ffwd_pid]}\n", "did you mean 'controller'"),
        ("name: mine\nvary: {controller: [pid, nope]}\n", "unknown controller 'nope'"),
        ("name: mine\nvary:\n  controller: [pid]\n  controller: [ffwd_pid]\n", "duplicate key"),
        ("name: mine\nvary: {controller: [pid]}\ncolour: red\n", "unknown key 'colour'"),
        ("just words\n", "unknown key 'just words'"),
        ("", "holds no keys"),
    ],
)
def test_bad_campaign_files_are_one_message(call: Call, tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "campaigns").mkdir()
    (tmp_path / "campaigns" / "mine.yaml").write_text(text)
    code, _, err = call("run", "campaign=mine")
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert written(tmp_path) == ["campaigns", "campaigns/mine.yaml"]


def test_a_run_ends_with_tables_and_page(call: Call, tmp_path: Path) -> None:
    code, out, err = call("run", *SMALL, "run_dir=one")
    assert (code, err) == (0, "")
    assert "4 tests, 0 failed" in out
    names = written(tmp_path / "one")
    for name in ("config.yaml", "plan.json", "manifest.json", "report.html", "tables/indicators.parquet"):
        assert name in names
    assert [name for name in names if name.endswith(".mcap")] == [
        f"logs/sine_0p5hz__{controller}/rep_0{number}.mcap" for controller in ("ffwd_pid", "pid") for number in (1, 2)
    ]
    assert "tables/table_5_5_1.csv" in names
    assert not [name for name in names if name.endswith(".part")]
    manifest = json.loads((tmp_path / "one" / "manifest.json").read_text())
    assert manifest["state"] == "complete"
    assert manifest["sessions"][0]["version"]


def test_a_run_that_is_there_is_resumed_and_another_refused(call: Call, tmp_path: Path) -> None:
    call("run", *SMALL, "run_dir=one")
    (tmp_path / "one/logs/sine_0p5hz__pid/rep_02.mcap").unlink()
    code, out, _ = call("run", *SMALL, "run_dir=one")
    assert code == 0 and "3 were there" in out
    (tmp_path / "one/logs/sine_0p5hz__pid/rep_01.mcap").unlink()
    code, out, _ = call("resume", "one", "--workers", "1")
    assert code == 0 and "3 were there" in out
    before = written(tmp_path)
    code, _, err = call("run", *SMALL, "run_dir=one", "seed=2")
    assert code == 2 and "seed: 1 there, 2 here" in err and err.count("\n") == 1
    assert written(tmp_path) == before


def test_a_sweep_is_a_run_for_each_job(call: Call, tmp_path: Path) -> None:
    code, out, err = call("run", *SMALL, "amplifier=low_gain,high_gain", "-m", "run_dir=sweep")
    assert (code, err) == (0, "")
    for number, amplifier in enumerate(("low_gain", "high_gain")):
        plan = json.loads((tmp_path / f"sweep/{number}/plan.json").read_text())
        assert {one["choices"]["amplifier"] for one in plan["conditions"]} == {amplifier}
        assert (tmp_path / f"sweep/{number}/report.html").exists()
    assert "the runs of the sweep are in sweep" in out


def test_failed_tests_give_exit_code_one(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    import hjcamp.backends
    from hjcamp.errors import HjcampError

    def fails(config: dict, seed: int) -> None:
        raise HjcampError("the joint broke")

    monkeypatch.setattr(hjcamp.backends, "run_test", fails)
    code, _, err = call("run", *SMALL, "run_dir=one")
    assert code == 1
    assert "4 tests failed" in err and "the joint broke" in err and "Traceback" not in err


def test_a_users_folder_works(call: Call, tmp_path: Path) -> None:
    (tmp_path / "campaigns").mkdir()
    text = "name: mine\nfixed: {controller: pid}\nvary: {controller.positive.kp: [1.0, 1.1]}\nrepetitions: 1\n"
    (tmp_path / "campaigns" / "mine.yaml").write_text(text)
    assert "kp=1.1" in call("plan", "campaign=mine").out
    assert call("run", "campaign=mine", "workers=1", "run_dir=r").code == 0
    assert (tmp_path / "r/logs/kp1p1/rep_01.mcap").exists()


def test_hydra_shows_the_configuration(call: Call, tmp_path: Path) -> None:
    code, out, _ = call("run", "campaign=controllers", "controller.positive.kp=1.3", "--cfg", "job")
    assert code == 0
    assert "kp: 1.3" in out and "trajectory:" in out
    assert re.search(r"campaign: .*\bcontrollers\b", call("run", "--help").out)
    assert written(tmp_path) == []


def test_config_dir_adds_choices(call: Call, tmp_path: Path) -> None:
    (tmp_path / "more/payload").mkdir(parents=True)
    (tmp_path / "more/payload/heavy.yaml").write_text("name: heavy\nmass_g: 50.0\nradius_mm: 20.0\n")
    out = call("run", "payload=heavy", "--config-dir", "more", "--cfg", "job").out
    assert "name: heavy" in out
    assert "payload heavy" in call("plan", "payload=heavy", "--config-dir", "more").out
    assert call("plan", "payload=heavy").code == 2


def test_plan_writes_nothing(call: Call, tmp_path: Path) -> None:
    code, out, _ = call("plan", "campaign=robustness_vertical")
    assert code == 0
    assert "8 conditions x 7 repetitions = 56 tests, 3 min 16 s of motion" in out
    narrow = ["campaign=robustness_vertical", "trajectory=mixed"]
    assert len(json.loads(call("plan", *narrow, "--json", "-").out)["tests"]) == 14
    shown = call("plan", *narrow, "--condition", "mixed__pid").out
    assert "payload_inertia" in shown and shown.startswith("# mixed__pid")
    assert call("plan", *narrow, "--condition", "mixed_pid").code == 2
    assert written(tmp_path) == []


def test_runs_are_listed_shown_and_reported(call: Call, tmp_path: Path) -> None:
    assert "no runs" in call("ls").out
    call("run", *SMALL)
    folder = next((tmp_path / "runs/robustness_vertical").iterdir())
    path = str(folder.relative_to(tmp_path))
    assert path in call("ls", "payload=brass_8p5g").out
    assert path not in call("ls", "payload=none").out
    assert "complete, 4 of 4 tests" in call("show", path).out
    assert call("report", path, "--output", "elsewhere").code == 0
    assert (tmp_path / "elsewhere/report.html").exists()
    code, _, err = call("report", path, "--check", "default")
    assert code == 1 and "outside the tolerances" in err
    assert call("log", "verify", path).out == "4 logs, 4 whole, 0 not\n"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "keep_going=no"), "keep_going is 'no'; true or false"),
        (("run", "-m", "seed=1,2", "keep_going=off"), "keep_going is 'off'"),
        (("run", "campaign=[controllers,leakage]"), "hjcamp run -m campaign=controllers,leakage"),
        (("run", f"controller.positive.kp={'1' * 5000}"), "4300 digits"),
        (("rig", "check", "rig=example_pcie", "rig.limits.pressure_high_mpa=null"), "pressure_high_mpa is null"),
        (("rig", "check", "rig=virtual", "rig.watchdog=true"), "rig.watchdog is true"),
        (("next", "procedure.preload_mpa=-3"), "procedure.preload_mpa is -3"),
        (("tune", "rig.scatter.friction_within=-3"), "friction_within is -3"),
        (("effects", "leakage", "payload.mass_g=-1", "--figure", "x.png"), "payload.mass_g is -1"),
    ],
)
def test_every_command_checks_the_values_first(call: Call, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    code, _, err = call(*arguments)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert written(tmp_path) == []


def test_run_names_the_file_that_hydra_would_stumble_over(call: Call, tmp_path: Path) -> None:
    (tmp_path / "conf" / "payload").mkdir(parents=True)
    (tmp_path / "conf" / "payload" / "none.yaml").write_text("defaults: [none]\nname: none\n")
    code, _, err = call("run")
    assert (code, err.count("\n")) == (2, 1)
    assert "the defaults of payload/none" in err
