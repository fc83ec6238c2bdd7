"""A user's folder with an axis, and its measured tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.plants._template import write_template


@pytest.fixture
def axis(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose only plant is the template's carriage."""
    monkeypatch.chdir(tmp_path)
    write_template("axis", Path("plants"), [])
    return tmp_path
