"""The measurement that files of other programs hold in the tests, and how it is imported."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hjcamp.records.elsewhere.importing import Imported, import_files
from hjcamp.records.read import read_log

CASES = Path(__file__).parent / "foreign_cases"
TIME, X, U = np.loadtxt(CASES / "truth.csv", delimiter=",", skiprows=1, unpack=True)
ROWS = len(TIME)
FIELDS: dict[str, Any] = {"time_s": "t", "position_m": {"column": "x", "unit": "mm"}, "voltage_v": "u"}


def imported(source: Path, mapping: Path) -> tuple[Imported, dict[str, np.ndarray]]:
    [one] = import_files([source], mapping, [Path("out.mcap")])
    return one, read_log(one.path).columns


def mapped(fields: dict[str, Any] | None = None, **more: Any) -> Path:
    """Write a map of the cases with other fields and further keys."""
    path = Path("map.yaml")
    path.write_text(yaml.safe_dump({"plant": "stage", "fields": FIELDS | (fields or {})} | more))
    return path


def is_truth(columns: dict[str, np.ndarray], near: float = 1e-3) -> None:
    assert len(columns["time_s"]) == ROWS
    np.testing.assert_allclose(columns["time_s"], 0.01 * np.arange(ROWS), atol=1e-9)
    np.testing.assert_allclose(1e3 * columns["position_m"], X, atol=near)
    np.testing.assert_allclose(columns["voltage_v"], U, atol=1e-6)
