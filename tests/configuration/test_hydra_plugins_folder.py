"""A folder ``hydra_plugins`` in the working folder is no part of the program: nothing in it is run."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import hjcamp

EVIL = "open('marker', 'w').close()\n"


@pytest.mark.parametrize("name", ["evil.py", "__init__.py"])
def test_nothing_in_it_is_run(name: str, empty_folder: Path) -> None:
    (empty_folder / "hydra_plugins").mkdir()
    (empty_folder / "hydra_plugins" / name).write_text(EVIL)
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    words = [sys.executable, "-m", "hjcamp", "plan", "repetitions=1"]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert not (empty_folder / "marker").exists()
