"""A folder with a plant of one's own and six seconds of its measurements."""

from __future__ import annotations

import shutil
from itertools import islice
from pathlib import Path

import pytest

from hjcamp.commands.shared.plant_template import write_template
from hjcamp.records.elsewhere.importing import import_files

SAMPLES = Path(__file__).parents[2] / "docs" / "own_plant"
ROWS = 3001


@pytest.fixture(scope="session")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the map and the beginnings of both measurements."""
    folder = tmp_path_factory.mktemp("samples") / "own_plant"
    folder.mkdir()
    shutil.copy(SAMPLES / "map.yaml", folder)
    for name in ("train.csv", "held_out.csv"):
        with (SAMPLES / name).open(encoding="utf-8") as stream:
            (folder / name).write_text("".join(islice(stream, ROWS)), encoding="utf-8")
    return folder


@pytest.fixture
def stage(samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder with the plant, ``logs/train.mcap``, and what an import needs."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    write_template("stage", Path("plants"), [])
    for name in ("map.yaml", "train.csv"):
        shutil.copy(samples / name, tmp_path)
    Path("logs").mkdir()
    import_files(["train.csv"], "map.yaml", ["logs/train.mcap"])
    return tmp_path
