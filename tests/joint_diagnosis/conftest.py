"""Cases of the truth plant, and a library of a few effects so that kernels compile quickly."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from discrepancy_answers import Answer, Call

import hjcamp.effects
from hjcamp import cli

sys.path.insert(0, str(Path(__file__).parents[1]))
from truth.pump_joint.case import write_case

LIBRARY = ("leakage", "pressure_offset", "stribeck_friction")


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Call:
    """Return the function that calls ``hjcamp ARGUMENTS`` in an empty folder."""
    everything = hjcamp.effects.load_effects([])
    few = {name: everything[name] for name in LIBRARY}
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    monkeypatch.setattr(hjcamp.effects, "load_effects", lambda folders=None: dict(few))
    # Other processes would load, and compile, the whole library.
    monkeypatch.setattr("hjcamp.workers.pool.available", lambda: 1)

    def answer(*arguments: str | Path) -> Answer:
        capfd.readouterr()
        code = cli.run([str(one) for one in arguments])
        out, err = capfd.readouterr()
        return Answer(code, out, err)

    return answer


@pytest.fixture(scope="session")
def leak(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Logs of a rig that leaks: 8 conditions with 3 repetitions."""
    folder = tmp_path_factory.mktemp("truth") / "leak"
    write_case(folder, ["leakage"], "medium", 101)
    return folder


@pytest.fixture(scope="session")
def stribeck(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Logs of a rig with a strong Stribeck effect."""
    folder = tmp_path_factory.mktemp("truth") / "stribeck"
    write_case(folder, ["stribeck_friction"], "strong", 5)
    return folder


@pytest.fixture(scope="session")
def null(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Logs of another rig in which nothing is missing."""
    folder = tmp_path_factory.mktemp("truth") / "null"
    write_case(folder, [], "medium", 4)
    return folder
