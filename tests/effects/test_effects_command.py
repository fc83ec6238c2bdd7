"""``hjcamp effects``: the catalogue, one effect, a new one, and one clear message for each mistake in a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.plants.pump_joint.answers import effects as command
from hjcamp.plants.pump_joint.figures.effect import draw_effect

GOOD = '''"""A spring."""

from math import sin

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class Mine(Effect):
    r"""A spring.

    .. math:: F = -k a
    """

    subsystem = "joint"
    stiffness = Parameter("N/rad", 0.5, (0.0, 50.0), text="stiffness", off=0.0)

    @staticmethod
    def load_force(arm_angle, stiffness):
        return -stiffness * arm_angle
'''
MISTAKES = {
    "syntax": ("return -stiffness * arm_angle", "return -stiffness *", "line 20: invalid syntax"),
    "unknown slot": ("def load_force(", "def load_forse(", "did you mean 'load_force'"),
    "unknown name": ("arm_angle, stiffness):", "arm_angel, stiffness):", "did you mean 'arm_angle'"),
    "wrong unit": ("-stiffness * arm_angle", "-stiffness * arm_angle * arm_angle / stiffness", "gives 1, but the slot"),
    "mixed units": ("-stiffness * arm_angle", "-stiffness * (arm_angle + stiffness)", "adds 1 and kg*m/s^2"),
    "function of a unit": ("-stiffness * arm_angle", "-stiffness * sin(stiffness)", "argument of sin must be a pure"),
    "not an SI unit": ('"N/rad"', '"N/deg"', "'N/deg' is not an SI unit"),
    "no unit at all": ('"N/rad"', '"newtonish"', "unknown unit 'newtonish'"),
    "later signal": ("arm_angle, stiffness):", "arm_angle, stiffness, friction):", "computed later than the slot"),
    "default out of bounds": ("0.5, (0.0, 50.0)", "60.0, (0.0, 50.0)", "default 60 is outside its bounds"),
    "two classes": ("class Mine(Effect):", "class Other(Mine):", "Mine"),
    "no state rate": (
        "    @staticmethod",
        '    z = State("m", 1e-9, 1e-3)\n\n    @staticmethod',
        "exactly one of d_z and next_z",
    ),
    "own start of no line": ("0.5, (0.0, 50.0)", "0.5, (0.0, 50.0), each_test=True", "marked each_test, which is for"),
    "unknown subsystem": ('"joint"', '"elbow"', "unknown subsystem 'elbow'"),
    "no static method": ("    @staticmethod\n", "", "must be a static method"),
    "behind no slot": ('subsystem = "joint"', 'subsystem = "joint"\n    behind = "load_forse"', "did you mean 'load_force'"),
    "behind, but adds": (
        'subsystem = "joint"',
        'subsystem = "joint"\n    behind = "load_force"',
        "'load_force' must take load_force",
    ),
    "raises": ("class Mine", "1 / 0\n\n\nclass Mine", "ZeroDivisionError"),
}


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Call ``hjcamp effects WORDS`` and return its exit code and what it printed."""
    code = cli.run(["effects", *words])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_catalogue_names_every_effect(empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys)
    assert code == 0
    assert "pump_backlash" in out and "pressure_gain" in out and "22 effects" in out


def test_one_effect_shows_equation_parameters_and_source(empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, "cross_leakage")
    assert code == 0
    assert "q_{12} = G" in out and "m^3/(s*Pa)" in out and "Merritt" in out and "0 ... 1e-11" in out
    # a picture is written where it is asked for alone
    assert "hjcamp effects cross_leakage --figure effect_cross_leakage.png" in out
    assert not list(empty_folder.iterdir())


def test_new_writes_a_file_once(empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert answer(capsys, "new", "stray_spring")[0] == 0
    path = empty_folder / "effects" / "stray_spring.py"
    text = path.read_text()
    assert "class StraySpring(Effect)" in text and "friction_static [N]" in text and "slider_acceleration" in text
    assert max(map(len, text.splitlines())) <= 120
    path.write_text(text + "# mine\n")
    code, _, err = answer(capsys, "new", "stray_spring")
    assert code == 2 and "exists" in err and path.read_text().endswith("# mine\n")
    assert [one.name for one in path.parent.iterdir()] == ["stray_spring.py"]
    assert "stray_spring" in answer(capsys)[1]


@pytest.mark.parametrize("name", ["leakage", "new", "Spring", "a-b", "../x", ""])
def test_new_refuses_a_bad_or_taken_name(empty_folder: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    code, _, err = answer(capsys, "new", name)
    assert code == 2 and "effect name" in err
    assert not list(empty_folder.rglob("*.py"))


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_faulty_file_is_one_clear_message(empty_folder: Path, capsys: pytest.CaptureFixture[str], mistake: str) -> None:
    old, new, said = MISTAKES[mistake]
    text = GOOD.replace(old, new) + ("" if mistake != "two classes" else "\n\n" + GOOD.partition("\n\n\n")[2])
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "mine.py").write_text(text)
    code, out, err = answer(capsys, "test", "mine")
    assert (code, out) == (2, "")
    assert err.count("\n") == 1 and "mine" in err and said in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("leakige",), "did you mean 'leakage'"),
        (("leakage", "--figure", "x.bmp"), "the suffix must be one of"),
        (("leakage", "trajectory=nowhere"), "unknown trajectory 'nowhere'"),
        (("leakage", "campaign=controllers"), "one test"),
        (("new",), "give one name"),
        (("test", "a", "b"), "give one name"),
        (("test", "leakige"), "did you mean 'leakage'"),
    ],
)
def test_a_wrong_call_is_one_clear_message(
    empty_folder: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    code, out, err = answer(capsys, *words)
    assert (code, out) == (2, "") and said in err
    assert not list(empty_folder.iterdir())


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_picture_is_written_whole(tmp_path: Path, suffix: str) -> None:
    time = np.arange(-100, 500) * 1e-3
    columns = {"time_s": time, "phase": np.where(time < 0, 2.0, 3.0), "reference_deg": time}
    columns |= {name: np.sin(time) for name in ("arm_deg", "pressure1_mpa", "pressure2_mpa")}
    path = tmp_path / "pictures" / f"it.{suffix}"
    draw_effect(path, "title", columns, {**columns, "arm_deg": np.cos(time)})
    assert path.stat().st_size > 5000
    assert [one.name for one in path.parent.iterdir()] == [path.name]


def test_the_test_of_the_picture_composes(empty_folder: Path) -> None:
    config = command.configured(["payload=brass_8p5g"])
    assert config["controller"]["name"] == "open_loop" and config["effects"]["payload_inertia"]["load_mass"] == 8.5e-3
