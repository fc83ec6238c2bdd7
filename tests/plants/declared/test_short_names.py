"""Equations as people shorten them, and what is said of names that are none."""

from __future__ import annotations

from pathlib import Path

import pytest
from wheel_plant import DRY_WHEEL, WHEEL

from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_bench import identified
from hjcamp.model.checks.plant_checks import check_measured
from hjcamp.model.language.vocabulary import read_vocabulary

HEAD = "def equations(state, parameter, drive, rate):\n"


def lines_of(folder: Path, text: str) -> list[str]:
    (folder / "plants").mkdir(exist_ok=True)
    (folder / "plants" / "wheel.py").write_text(text)
    return [f"{one.target} = {one.expression}" for one in read_vocabulary(find_plant("wheel")).statements]


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(HEAD, f"{HEAD}        p, s = parameter, state\n").replace("parameter.", "p.").replace("state.", "s."),
        lambda text: text.replace(HEAD, f"{HEAD}        d = drive\n        r = rate\n").replace("drive.", "d.").replace("rate.", "r."),
        lambda text: text.replace(HEAD, "def equations(x, q, u, dx):\n").replace("parameter.", "q.").replace("state.", "x.")
        .replace("drive.", "u.").replace("rate.", "dx."),
        lambda text: text.replace('        load = outside("N*m")\n', "").replace(
            "torque = actuator(parameter.gain * drive.voltage)",
            'torque, load = actuator(parameter.gain * drive.voltage), outside("N*m")',
        ),
    ],
)  # fmt: skip
def test_short_names_are_the_same_equations(folder: Path, change) -> None:  # type: ignore[no-untyped-def]
    assert lines_of(folder, change(WHEEL)) == lines_of(folder, WHEEL)


def test_names_that_are_swapped_stay_on_one_line(folder: Path) -> None:
    swapped = f"{HEAD}        first = 1.0\n        second = 2.0\n        first, second = second, first\n"
    with pytest.raises(UsageError, match="one name for each line"):
        lines_of(folder, WHEEL.replace(HEAD, swapped))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mass=parameter.inertia", "mass=inertia", "'inertia' is written parameter.inertia"),
        ("contact, outside", "contact, outside, where", "A choice is written 'A if CONDITION else B'"),
        ("contact, outside", "contact, outsid", "did you mean 'outside'"),
    ],
)
def test_what_is_said_of_a_name_that_is_none(folder: Path, old: str, new: str, said: str) -> None:
    (folder / "plants" / "wheel.py").write_text(WHEEL.replace(old, new))
    with pytest.raises(UsageError, match=said):
        identified(find_plant("wheel"))


def test_a_sensor_that_is_no_line_is_told_with_its_line(folder: Path) -> None:
    (folder / "plants" / "wheel.py").write_text(WHEEL.replace("        encoder = sensor(state.speed)\n", ""))
    with pytest.raises(UsageError, match=r"encoder = sensor\(state.speed\)"):
        check_measured(find_plant("wheel"))


def test_inputs_too_small_to_move_anything_are_told(folder: Path) -> None:
    (folder / "plants" / "wheel.py").write_text(DRY_WHEEL.replace('"N*m", 1.2e-3, (1e-7, 1e-1)', '"N*m", 2.0, (1e-7, 10.0)'))
    with pytest.raises(
        UsageError, match=r"under voltage of up to 6 V \(twice its typical=\.\.\.; does that move the machine\?\)"
    ):
        identified(find_plant("wheel"))
