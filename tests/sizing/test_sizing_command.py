"""``hjcamp sizing``: the table, what the joint can do, the figures, and one clear line for every misuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.plants.pump_joint.sizing.capability import (
    Friction,
    Joint,
    largest_torque,
    limits,
    needed_pressure,
    read_question,
    verdict,
)

JOINT = Joint(4e-3, 20e-3, 6.82e-3, 0.689e6, 2.5, 0.22)
WORN = Friction("worn, positive", 7.20, 5.27)


def answers(capfd: pytest.CaptureFixture[str], *words: str) -> dict[str, dict]:
    assert cli.run(["sizing", "capability", *words, "--json", "-"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert found["schema"] == "hjcamp.capability/1"
    return {one["friction"]: one for one in found["answers"]}


def test_the_table_meets_the_print(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["sizing", "--json", "sizing.json"]) == 0
    out = capfd.readouterr().out
    assert "25 of 25 printed values are met" in out
    assert "8.5" in out and "78.5" in out
    found = json.loads(Path("sizing.json").read_text())["quantities"]
    assert all(one["agrees"] is not False for one in found)


def test_the_objectives_of_the_thesis(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    found = answers(capfd, "torque_mnm=20", "range_deg=180", "diameter_mm=15")
    moving = {name: round(one["limits"][0]["needed"], 3) for name, one in found.items()}
    # (20 mNm / r_p + F_c) / A_2 by hand.
    assert moving == {"worn, positive": 0.886, "worn, negative": 0.703, "first state": 0.564, "reduced": 0.546}
    assert [one["verdict"] for one in found.values()] == [*["no: friction, envelope"] * 2, *["no: envelope"] * 2]
    assert found["reduced"]["limits"][2]["needed"] == pytest.approx(10.71, abs=0.01)


def test_the_torque_at_a_pressure(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    found = answers(capfd, "torque_mnm=16", "pressure_mpa=0.6")
    torque = [round(one["largest_torque_mnm"], 1) for one in found.values()]
    assert torque == [7.7, 15.6, 21.6, 22.3]
    assert [one["verdict"] for one in found.values()] == ["no: friction", "no: friction", "yes", "yes"]


def test_a_pressure_beyond_the_sensors_is_told(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for pressure, told in (("0.6", False), ("1.2", True)):
        assert cli.run(["sizing", "capability", "torque_mnm=20", f"pressure_mpa={pressure}"]) == 0
        assert ("beyond what the sensors measure: counted with their 0.689 MPa" in capfd.readouterr().out) is told


def test_another_joint_and_friction(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    found = answers(capfd, "torque_mnm=20", "joint.bore_mm=8", "friction=bidirectional")
    assert [one["verdict"] for one in found.values()] == ["yes", "yes"]
    assert found["worn, positive"]["limits"][0]["needed"] == pytest.approx(0.886 / 4, abs=5e-4)


@pytest.mark.parametrize(
    ("words", "stop"),
    [
        (["torque_mnm=25", "pressure_mpa=0.3"], "no: pressure"),
        (["torque_mnm=40"], "no: sensor range"),
        (["torque_mnm=15"], "no: friction"),
        (["torque_mnm=10"], "only while it moves: friction"),
        (["range_deg=350"], "no: stroke"),
        (["diameter_mm=18"], "no: envelope"),
        (["diameter_mm=20", "range_deg=336", "torque_mnm=4"], "yes"),
    ],
)
def test_each_limit_stops_it(words: list[str], stop: str) -> None:
    assert verdict(limits(read_question(words), JOINT, WORN)) == stop


def test_torque_and_pressure_undo_each_other() -> None:
    assert largest_torque(needed_pressure(0.013, 3.0, JOINT), 3.0, JOINT) == pytest.approx(0.013)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["capability"], "needs a limit"),
        (["capability", "pressure_mpa=0.3"], "needs a limit"),
        (["capability", "torqe_mnm=20"], "did you mean 'torque_mnm'"),
        (["capability", "torque_nm=0.02"], "unknown quantity 'torque_nm'"),
        (["capability", "range_rad=3"], "unknown quantity 'range_rad'"),
        (["capability", "torque_mnm=20 Nm"], "a number is needed, without a unit; mNm is in the name"),
        (["capability", "torque_mnm=0"], "a number above 0"),
        (["capability", "diameter_mm=-15"], "a number above 0"),
        (["capability", "torque_mnm=nan"], "a number above 0"),
        (["capability", "torque_mnm=1e300"], "up to 1e+06"),
        (["capability", "torque_mnm"], "KEY=NUMBER is needed"),
        (["capability", "torque_mnm=1", "torque_mnm=2"], "given twice"),
        (["capability", "torque_mnm=1", "joint.bore_mm=-4"], "joint.bore_mm is -4"),
        (["capability", "torque_mnm=1", "joint.boree_mm=4"], "did you mean 'bore_mm'"),
        (["capability", "torque_mnm=1", "friction=worn"], "unknown friction 'worn'"),
        (["capabilty"], "did you mean 'capability'"),
        (["figures", "torque_mnm"], "figures takes overrides of the joint"),
        (["figures", "friction=worn"], "unknown friction 'worn'"),
        (["figures", "payload.mass_g=-1"], "payload.mass_g is -1"),
    ],
)
def test_misuse_is_one_line(words: list[str], said: str, empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["sizing", *words]) == 2
    out, err = capfd.readouterr()
    assert said in err and out == "" and len(err.splitlines()) == 1
    assert not list(empty_folder.iterdir())


def test_the_figures_are_drawn(empty_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["sizing", "figures", "--output", "drawn"]) == 0
    names = {path.stem for path in Path("drawn").iterdir()}
    own = {"figure_4_5_2", "figure_5_5_9"}
    assert names - own == {
        "figure_3_3_3",
        "figure_3_4_1",
        "figure_3_5_3",
        "string_torque",
        "figure_4_4_3",
        "figure_5_6_5",
    }
    assert own <= names
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in Path("drawn").iterdir())
    assert capfd.readouterr().out.count("picture") == 8
