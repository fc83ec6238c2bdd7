"""What tests of logs share."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from foreign_truth import CASES


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a user's folder with the plant of the cases that is the working directory."""
    shutil.copytree(CASES / "plants", tmp_path / "plants")
    monkeypatch.chdir(tmp_path)
    return tmp_path
