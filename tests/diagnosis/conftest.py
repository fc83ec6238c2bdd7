"""A user's folder with an axis, and its measured tests."""

from __future__ import annotations

from pathlib import Path

import pytest
from gauge import PLANT

from hjcamp.commands.shared.plant_template import write_template


@pytest.fixture
def axis(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose only plant is the template's carriage."""
    monkeypatch.chdir(tmp_path)
    write_template("axis", Path("plants"), [])
    return tmp_path


@pytest.fixture
def tanks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose only plant is two tanks."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "tanks.py").write_text(PLANT, encoding="utf-8")
    return tmp_path
