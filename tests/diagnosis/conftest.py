"""A user's folder with an axis, and its measured tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import slab as heated
from gauge import PLANT

from hjcamp.commands.shared.plant_template import write_template
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.records.log import TestLog


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


@pytest.fixture
def slab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """Two tests of a heated block, by its closed form, in a folder with its plant."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "slab.py").write_text(heated.PLANT)
    generator = np.random.default_rng(8)
    logs = []
    for number, begin in enumerate((25.0, 3.0)):
        power = np.repeat(generator.uniform(0.0, 80.0, 30), 100)
        warmth = heated.course(2.5, begin, power) + heated.NOISE * generator.standard_normal(len(power))
        columns = {"time_s": np.arange(float(len(power))), "warmth_k": warmth, "power_w": power}
        logs.append(TestLog(columns, {"plant": "slab", "period_s": "1.0", "condition": str(number)}))
    return measured_tests(logs)
