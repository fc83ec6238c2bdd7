"""A plant of ours may be a folder; what belongs to it alone is asked of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.known_plants import OWN_PLANTS, load_plants, plant_names
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.catalogue import scan
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.two_pumps.plant import TwoPumps

FOLDER = '''"""A tank."""
from hjcamp.model.declare.parameter import State
from hjcamp.model.declare.plant import Plant


class Tank(Plant):
    """A tank."""

    level = State("m")
'''


def test_a_folder_with_a_file_of_its_kind_is_called_like_the_folder(tmp_path: Path) -> None:
    package = tmp_path / "own_machines_of_a_test"
    (package / "tank").mkdir(parents=True)
    for file in (package / "__init__.py", package / "tank/__init__.py", package / "tank/numbers.py"):
        file.write_text("")
    (package / "tank/plant.py").write_text(FOLDER)
    sys.path.insert(0, str(tmp_path))
    try:
        assert [(name, one.name) for name, one in scan(package, package.name, Plant).items()] == [("tank", "tank")]
    finally:
        sys.path.remove(str(tmp_path))
    assert list(load_plants([])) == ["pump_joint", "two_pumps", "valve_joint"]
    assert scan(OWN_PLANTS, "hjcamp.plants", Plant)["pump_joint"] is PumpJoint


def test_a_users_plant_may_be_a_folder_too(tmp_path: Path) -> None:
    for name in ("tank", "_not_one"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "plant.py").write_text(FOLDER)
    assert load_plants([tmp_path])["tank"].name == "tank"
    assert plant_names(tmp_path) == ["tank"]
    (tmp_path / "tank.py").write_text(FOLDER)
    with pytest.raises(UsageError, match="'tank' is taken"):
        load_plants([tmp_path])
    (tmp_path / "tank.py").unlink()
    (tmp_path / "my-tank").mkdir()
    (tmp_path / "my-tank/plant.py").write_text(FOLDER)
    with pytest.raises(UsageError, match="'my-tank' cannot be a name"):
        load_plants([tmp_path])


def test_the_joint_answers_for_its_hardware_and_another_plant_has_none(composer: Composer) -> None:
    config = composer.compose([]).config
    assert set(PumpJoint.rig) < set(PumpJoint.settings())
    PumpJoint.check_settings(config)
    values = PumpJoint.configured(config)
    assert values.keys() <= PumpJoint.parameters.keys() and values["pump_delay"] == 2e-3
    assert {course.driven.shape[1] for course in PumpJoint.courses().values()} == {1}
    assert not TwoPumps.rig and not TwoPumps.settings() and not TwoPumps.configured(config) and not TwoPumps.courses()


def test_the_schema_of_the_joint_does_not_import_its_equations() -> None:
    code = "import sys, hjcamp.plants.pump_joint.schema as _; print('hjcamp.plants.pump_joint.plant' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"
