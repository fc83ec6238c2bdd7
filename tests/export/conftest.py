"""Plants whose models leave as files, and a Python that has numpy alone."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.plant import Plant

# An import of what is not numpy or Python's own raises there.
ALONE = """
import importlib.util, json, sys
sys.modules.update(dict.fromkeys(("hjcamp", "numba", "scipy", "polars", "control"), None))
spec = importlib.util.spec_from_file_location("exported", sys.argv[1])
exported = importlib.util.module_from_spec(spec)
spec.loader.exec_module(exported)
tests = json.load(sys.stdin)
found = []
for one in tests:
    readings, states = exported.simulate(one["inputs"], one["start"])
    found.append({name: values.tolist() for name, values in {**states, **readings}.items()})
json.dump(found, sys.stdout)
"""


@pytest.fixture
def carriage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> type[Plant]:
    """The carriage of the template in ./plants of an empty folder: an axis with dry friction."""
    folder = tmp_path / "plants"
    folder.mkdir()
    (folder / "carriage.py").write_text(TEMPLATE.format(title="Carriage"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return find_plant("carriage")


@pytest.fixture
def simulate_alone(tmp_path: Path) -> Callable[[str, list[dict[str, Any]]], list[dict[str, np.ndarray]]]:
    """Return what an exported text simulates in a process that can import numpy alone: states and readings of each test."""

    def call(text: str, tests: list[dict[str, Any]]) -> list[dict[str, np.ndarray]]:
        file = tmp_path / "exported.py"
        file.write_text(text, encoding="utf-8")
        command = [sys.executable, "-I", "-W", "error", "-c", ALONE, str(file)]
        done = subprocess.run(command, input=json.dumps(tests), capture_output=True, text=True, check=False, timeout=120)
        assert done.returncode == 0, done.stderr
        return [{name: np.array(values) for name, values in one.items()} for one in json.loads(done.stdout)]

    return call
