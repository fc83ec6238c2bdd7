"""What a plant does for itself: its modules answer the calls of any plant's, and nothing else of the program names the plant."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import hjcamp
from hjcamp import backends, cli
from hjcamp.backends import plant_simulation
from hjcamp.commands import command_files
from hjcamp.commands.any_plant import calls
from hjcamp.controllers import load_controllers
from hjcamp.errors import UsageError
from hjcamp.known_plants import folders_in_plants, plant_called, plant_of, usual_plant
from hjcamp.model.files.rooms import ROOMS
from hjcamp.notebook import _any_plant as in_python

# What does for any plant what a room may do for one.
FOR_ANY: tuple[tuple[str, ModuleType], ...] = (
    *((room, calls) for room in ("compare", "diagnose", "add", "calibrate", "next")),
    ("python", in_python),
    ("simulation", plant_simulation),
)
NAMES = re.compile(r"pump|pressure1|arm_deg|arm_angle", re.IGNORECASE)
# The usual plant's name, which logs and models that name none stand for.
NAMED_BY = {"known_plants.py", "diagnosis/results/model_file.py"}


def parameters_of(function: object) -> list[str]:
    """Return the names of a function's parameters; those of one kind may have other names where they go by place."""
    return [one.kind.name for one in inspect.signature(function).parameters.values()]  # type: ignore[arg-type]


@pytest.mark.parametrize(("room", "anybody"), FOR_ANY, ids=[one[0] for one in FOR_ANY])
def test_a_room_answers_the_calls_of_any_plant(room: str, anybody: ModuleType) -> None:
    own = usual_plant().own_room(room)
    assert own is not anybody
    for name in ROOMS[room]:
        ours, anyones = getattr(own, name), getattr(anybody, name)
        assert callable(ours) == callable(anyones), name
        assert not callable(ours) or parameters_of(ours) == parameters_of(anyones), name


@pytest.mark.parametrize("room", ROOMS)
def test_the_usual_plant_has_every_room_with_what_it_must_hold(room: str) -> None:
    assert usual_plant().room_of(room) is not None


OWN = """from rich.console import Console

def calibrate(data, name, only, conf, replace, json):
    Console().print(f"{len(data.logs)} test of {data.plant_name}, by a module of its own, as {name}", markup=False)
"""


def test_a_users_plant_has_a_room_in_its_folder(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plants = folder / "plants"
    (plants / "vessel").mkdir()
    text = (plants / "tanks.py").read_text().replace("class Tanks", "class Vessel")
    rooms = '    rooms = {"calibrate": "own_calibration.py"}\n    upper = State'
    (plants / "vessel" / "plant.py").write_text(text.replace("    upper = State", rooms, 1))
    (plants / "vessel" / "own_calibration.py").write_text(OWN)
    steps = "trajectory.segments=[{to_v: 4, in: 0.1, law: linear}, {rest: 0.1}]"
    assert cli.run(["run", "plant=vessel", "trajectory=segments", steps, "repetitions=1", "run_dir=out"]) == 0
    capsys.readouterr()
    assert cli.run(["calibrate", "out", "--as", "mine"]) == 0
    assert capsys.readouterr().out == "1 test of vessel, by a module of its own, as mine\n"
    (plants / "vessel" / "own_calibration.py").write_text("def calibrated(): pass\n")
    assert cli.run(["calibrate", "out", "--as", "mine"]) == 2
    assert "plant vessel, room 'calibrate': own_calibration.py has no 'calibrate'" in capsys.readouterr().err
    (plants / "vessel" / "plant.py").write_text(text.replace("    upper = State", rooms.replace("calibrate", "calibrat", 1), 1))
    assert cli.run(["calibrate", "out", "--as", "mine"]) == 2
    assert "unknown room 'calibrat' in Vessel, rooms; did you mean 'calibrate'" in capsys.readouterr().err


def test_a_plant_without_rooms_is_done_by_what_does_any() -> None:
    plant = plant_called("two_pumps")
    assert plant.room_of("compare") is None
    with pytest.raises(UsageError, match="plant two_pumps has no tables"):
        plant.own_room("tables")
    config = {"plant": {"name": "two_pumps"}, "backend": {"name": "nidaqmx"}}
    with pytest.raises(UsageError, match="plant two_pumps has no nidaqmx"):
        backends.run_test(config, 1)


def test_a_configuration_without_a_plant_is_of_the_usual_one() -> None:
    assert plant_of({}) is plant_of({"plant": None}) is usual_plant()
    assert plant_of({"plant": {"name": "valve_joint"}}).name == "valve_joint"


def test_laws_and_commands_are_found_in_the_folders_of_plants() -> None:
    laws = load_controllers()
    for folder, package in folders_in_plants("controllers"):
        for path in folder.glob("[!_]*.py"):
            assert laws[path.stem].__module__ == f"{package}.{path.stem}"
    assert laws["given"].__module__ == "hjcamp.controllers.given"
    assert command_files()["sizing"].parts[-3:] == ("pump_joint", "commands", "sizing.py")
    assert list(command_files()) == sorted(command_files())


def test_nothing_outside_the_plants_names_one() -> None:
    root = Path(hjcamp.__file__).parent
    naming = {
        path.relative_to(root).as_posix()
        for path in root.rglob("*.py")
        if path.relative_to(root).parts[0] not in ("plants", "effects") and NAMES.search(path.read_text(encoding="utf-8"))
    }
    assert naming == NAMED_BY


def test_the_equations_load_no_room() -> None:
    code = (
        "import sys; from hjcamp.known_plants import load_plants; plants = load_plants([]);"
        "rooms = [room for one in plants.values() for room in one.rooms.values()];"
        "loaded = sorted(set(rooms) & set(sys.modules)); assert rooms and not loaded, loaded"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
