"""What a plant does for itself: its modules answer the calls of any plant's, and nothing else of the program names the plant."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import pytest

import hjcamp
from hjcamp import backends
from hjcamp.backends import plant_simulation
from hjcamp.commands import command_files
from hjcamp.commands.any_plant import calls
from hjcamp.controllers import load_controllers
from hjcamp.errors import UsageError
from hjcamp.known_plants import folders_in_plants, load_plants, plant_called, plant_of, usual_plant
from hjcamp.notebook import _any_plant as in_python

# What is called -> the room that may do it, and the module that does it for any plant.
CALLS: tuple[tuple[str, ModuleType, tuple[str, ...]], ...] = (
    ("compare", calls, ("compare",)),
    ("diagnose", calls, ("diagnose",)),
    ("add", calls, ("add",)),
    ("calibrate", calls, ("calibrate",)),
    ("next", calls, ("propose",)),
    (
        "python",
        in_python,
        (
            "compared", "comparison_sentences", "comparison_drawn", "comparison_page", "diagnosed", "diagnosis_sentences",
            "diagnosis_drawn", "diagnosis_page", "added", "calibrated",
        ),
    ),
    ("simulation", plant_simulation, ("run_test", "kernel_texts")),
)  # fmt: skip
# What only the usual plant has: what the program asks of it by these names.
ASKED: Mapping[str, tuple[str, ...]] = {
    "tables": ("diagnose_tables", "compare_tables", "add_table", "is_answer"),
    "effects": ("configured", "draw", "paint", "checks"),
    "curve": ("begun",),
    "tune": ("stability_method", "tune_campaign"),
    "kernels": ("warm",),
    "configuration": ("check_test", "check_model"),
    "nidaqmx": ("run_test", "notices", "before_moving", "look_again"),
    "watches": ("rig_watches",),
    "indicators": ("INDICATORS", "FURTHER", "error_indicators", "line_indicators"),
    "panels": ("PANELS", "SIGNALS"),
    "published": ("CONDITION", "MEASURED_WITH", "CAMPAIGNS", "cell_key", "published_cells", "standing", "beside_refit"),
    "run": ("pictures", "note", "next_commands"),
}
NAMES = re.compile(r"pump|pressure1|arm_deg|arm_angle", re.IGNORECASE)
# The usual plant's name, which logs and models that name none stand for.
NAMED_BY = {"known_plants.py", "prediction/model_file.py"}
# Still to be moved: what judges the joint by tables.
LEFT = "tabulated/"


def parameters_of(function: object) -> list[str]:
    """Return the names of a function's parameters; those of one kind may have other names where they go by place."""
    return [one.kind.name for one in inspect.signature(function).parameters.values()]  # type: ignore[arg-type]


@pytest.mark.parametrize(("room", "anybody", "names"), CALLS, ids=[one[0] for one in CALLS])
def test_a_room_answers_the_calls_of_any_plant(room: str, anybody: ModuleType, names: tuple[str, ...]) -> None:
    own = usual_plant().room(room)
    assert own is not None and own is not anybody
    for name in names:
        assert parameters_of(getattr(own, name)) == parameters_of(getattr(anybody, name)), name


def test_every_room_of_a_plant_that_comes_along_is_asked_for_by_what_it_has() -> None:
    known = {room: names for room, _, names in CALLS} | dict(ASKED)
    for plant in load_plants([]).values():
        assert set(plant.rooms) <= set(known), plant.name
        for room in plant.rooms:
            missing = [name for name in known[room] if not hasattr(plant.own_room(room), name)]
            assert not missing, (plant.name, room, missing)
    assert set(usual_plant().rooms) == set(known)


def test_a_plant_without_rooms_is_done_by_what_does_any() -> None:
    plant = plant_called("two_pumps")
    assert plant.room("compare") is None
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
    assert command_files()["rig"].parts[-3:] == ("pump_joint", "commands", "rig.py")
    assert list(command_files()) == sorted(command_files())


def test_nothing_outside_the_plants_names_one() -> None:
    root = Path(hjcamp.__file__).parent
    naming = {
        path.relative_to(root).as_posix()
        for path in root.rglob("*.py")
        if path.relative_to(root).parts[0] not in ("plants", "effects")
        and NAMES.search(path.read_text(encoding="utf-8"))
    }
    assert {name for name in naming if not name.startswith(LEFT)} == NAMED_BY


def test_the_equations_load_no_room() -> None:
    code = (
        "import sys; from hjcamp.known_plants import load_plants; plants = load_plants([]);"
        "rooms = [room for one in plants.values() for room in one.rooms.values()];"
        "loaded = sorted(set(rooms) & set(sys.modules)); assert rooms and not loaded, loaded"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
