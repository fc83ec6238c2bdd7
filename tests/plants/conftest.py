"""A user's folder with plants: a carriage with dry friction, two tanks without any contact, an arm with all kinds of places."""

from __future__ import annotations

from pathlib import Path

import pytest
from plant_texts import PRESS, ROTOR, TANKS
from wheel_plant import DRIVER, DRY_WHEEL, WHEEL

from hjcamp.commands.shared.plant_template import TEMPLATE

AXIS = TEMPLATE.format(title="Axis")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a user's folder that is the working directory."""
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "axis.py").write_text(AXIS)
    (tmp_path / "plants" / "tanks.py").write_text(TANKS)
    (tmp_path / "plants" / "rotor.py").write_text(ROTOR)
    (tmp_path / "plants" / "press.py").write_text(PRESS)
    (tmp_path / "plants" / "wheel.py").write_text(WHEEL)
    (tmp_path / "plants" / "dry_wheel.py").write_text(DRY_WHEEL)
    (tmp_path / "plants" / "driver.py").write_text(DRIVER)
    monkeypatch.chdir(tmp_path)
    return tmp_path
