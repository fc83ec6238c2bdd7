"""A user's rig file: what is wrong with it is one message that says what is allowed; templates pass as they are."""

from __future__ import annotations

from pathlib import Path

import pytest
from lab_of_rigs import MOTION, RIG

from hjcamp import cli

POSITION = 'Channel("position_m", range=(-1.0, 1.0))'
VOLTAGE = 'Channel("voltage", range=(-10.0, 10.0))'

#: What is replaced in the sound file, by what, and what is said.
WRONG = {
    "a channel that is misspelt": (POSITION, 'Channel("positon_m")', "unknown channel 'positon_m' in rig 'bench', plant axis1"),
    "no channel of a reading": (f"{POSITION}, {VOLTAGE}", f"{VOLTAGE},", "no channel shows position_m"),
    "no channel of an input": (f"{POSITION}, {VOLTAGE}", f"{POSITION},", "no channel gives the input voltage"),
    "two of one name": (VOLTAGE, POSITION, "two channels are called 'position_m'"),
    "a unit that is none": (POSITION, 'Channel("position_m", unit="inch")', "unknown unit 'inch'"),
    "a unit of another kind": (POSITION, 'Channel("position_m", unit="deg")', "unknown unit of m 'deg' in channel 'position_m'"),
    "a sign that is none": (POSITION, 'Channel("position_m", sign=2)', "sign is 2; 1 or -1 is needed"),
    "a range upside down": ("range=(-1.0, 1.0)", "range=(1.0, -1.0)", "range is (1.0, -1.0); a pair (lowest, highest)"),
    "a safe value out of range": (VOLTAGE, 'Channel("voltage", range=(1.0, 2.0))', "safe is 0, outside its range (1, 2)"),
    "an argument that there is not": (POSITION, 'Channel("position_m", units="m")', "'units'"),
    "channels that are none": (f"({POSITION}, {VOLTAGE})", '["position_m"]', "a tuple of Channel(...) is needed"),
    "no read": ("def read", "def reed", "rig 'bench' has no read()"),
    "another plant": ('plant = "axis1"', 'plant = "axis2"', "rig 'bench' is of plant axis2; this test is of plant axis1"),
    "a deadline that is none": ("    def read", "    deadline_s = 0\n    def read", "deadline_s is 0; a number above 0"),
    "no class": ("class Bench(Rig)", "class Bench", "no class derived from Rig in this file"),
    "a syntax error": ("def read(self):", "def read(self)", "rigs/bench.py: line 8"),
    "limits that exclude the start": ("range=(-1.0, 1.0)", "limits=(0.001, 0.1)", "trajectory begins at 0 m; position_m is limited to"),
    "limits that exclude the end": ("range=(-1.0, 1.0)", "limits=(-0.1, 0.004)", "trajectory goes to 0.005 m; position_m"),
    "an interlock that is no name": ("    def read", "    interlock = 'no'\n    def read", "rig.interlock is 'no'; name what"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_with_a_file_is_one_message(lab: Path, case: str, capfd: pytest.CaptureFixture[str]) -> None:
    old, new, said = WRONG[case]
    assert old in RIG
    (lab / "rigs" / "bench.py").write_text(RIG.replace(old, new))
    assert cli.run(["plan", *MOTION, "backend=rig", "rig=bench"]) == 2
    err = capfd.readouterr().err
    assert said in err and err.count("\n") == 1


def test_two_rigs_of_one_name_and_names_that_are_taken(
    lab: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (lab / "rigs" / "simulated.py").write_text(RIG)
    (lab / "rigs" / "bench").mkdir()
    for path in ("rigs/bench.py", "rigs/bench/rig.py"):
        (lab / path).write_text(RIG)
    for rig, said in (("bench", "the name 'bench' is taken"), ("bensch", "did you mean 'bench'")):
        assert cli.run(["plan", *MOTION, "backend=rig", f"rig={rig}"]) == 2
        assert said in capfd.readouterr().err
    assert cli.run(["rigs"]) == 0
    out = capfd.readouterr().out
    assert "not a rig: " in out and "the name 'simulated' is taken" in out


def test_a_rig_of_the_joint_and_no_rig_are_refused(lab: Path, capfd: pytest.CaptureFixture[str]) -> None:
    said = {
        "rig=example_pcie": "rig 'example_pcie' wires plant pump_joint; plant axis1 needs a file rigs/NAME.py",
        "plant=axis1": "backend=rig needs a rig: rig=NAME of rigs/NAME.py, or one of simulated, virtual",
    }
    for line, words in said.items():
        assert cli.run(["plan", *MOTION, "backend=rig", line]) == 2
        assert words in capfd.readouterr().err


@pytest.mark.parametrize("kind", [[], ["--serial"], ["--daqmx"]])
def test_a_template_fits_its_plant_and_passes_its_test(lab: Path, kind: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["rigs", "new", "bench", *kind]) == 0
    assert cli.run(["rigs", "test", "bench"]) == 0, capfd.readouterr().err
    out = capfd.readouterr().out
    assert out.count("  ok     ") == 15 and "FAILED" not in out and "its own was not opened" in out
    assert cli.run(["rigs", "new", "bench", *kind]) == 2
    assert "exists; it is left as it is" in capfd.readouterr().err


def test_a_file_is_listed_and_said_to_be_a_program(lab: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (lab / "rigs" / "bench.py").write_text(RIG)
    assert cli.run(["rigs"]) == 0
    out = " ".join(capfd.readouterr().out.split())
    assert "The axis on my bench." in out and "position_m, voltage" in out and "a file in ./rigs is a program" in out
