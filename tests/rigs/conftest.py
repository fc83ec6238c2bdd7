"""A lab with one plant of its own, an axis whose sensor is noisy, and no rig yet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lab_of_rigs import AXIS, MOTION, Made

from hjcamp.backends.rig import lock
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a user's folder that is the working directory, with a home and a folder of locks of its own."""
    (tmp_path / "plants").mkdir()
    (tmp_path / "rigs").mkdir()
    (tmp_path / "plants" / "axis1.py").write_text(AXIS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    monkeypatch.setattr(lock, "lock_folder", lambda: tmp_path)
    yield tmp_path
    lock.release_locks()


@pytest.fixture
def made(lab: Path) -> Made:
    """Return the function that gives the checked configuration of one test."""

    def configuration(*lines: str) -> dict[str, Any]:
        config = Composer().compose([free(line) for line in (*MOTION, *lines)]).config
        check_configuration(config)
        return config

    return configuration
