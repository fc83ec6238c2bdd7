"""A composer that is made once, and an empty working folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.configuration.composer import Composer


@pytest.fixture(scope="session")
def composer() -> Composer:
    """One composer over our own configuration."""
    return Composer()


@pytest.fixture
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder without the user's settings."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    return tmp_path
