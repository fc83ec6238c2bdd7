"""A free law over a drive that takes few values is told at these, and straight between them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slab import NOISE, PLANT, course

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.free_curve import curve_of, knots_of
from hjcamp.diagnosis.decision.verdict import OUTSIDE, decided
from hjcamp.records.log import TestLog

LEVELS = np.array([0.0, 15.0, 55.0, 80.0])
HEAT = np.array([0.0, 22.0, 55.0, 64.0])


def test_a_law_over_a_drive_of_few_values_is_told_at_these(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    text = PLANT.replace("import Input", "import actuator, Input").replace(
        "        rate.warmth = (drive.power -", "        heat = actuator(drive.power)\n        rate.warmth = (heat -"
    )
    (tmp_path / "plants" / "slab.py").write_text(text)
    generator, logs = np.random.default_rng(3), []
    for number in range(2):
        chosen = np.repeat(generator.integers(0, len(LEVELS), 60), 50)
        warmth = course(2.0, 20.0, HEAT[chosen]) + NOISE * generator.standard_normal(len(chosen))
        columns = {"time_s": np.arange(float(len(chosen))), "warmth_k": warmth, "power_w": LEVELS[chosen]}
        logs.append(TestLog(columns, {"plant": "slab", "period_s": "1.0", "condition": str(number)}))
    analysis = calibrated(measured_tests(logs), {})
    verdict = decided(analysis)
    assert verdict.word == OUTSIDE and verdict.term is not None
    [name] = verdict.term.names
    assert analysis.search.unknowns[name].driver == "demand"
    found = knots_of(analysis, verdict.term, name)
    assert found["x"] == pytest.approx(LEVELS, abs=1e-6)
    # the loss takes its share of what the law says: their difference is told
    loss = verdict.term.fitted.candidate.base["loss"]
    assert (LEVELS + found["y"]) / loss == pytest.approx(HEAT / 2.0, abs=1.0)
    curve = curve_of(analysis, verdict.term, name)
    assert curve["y"] == pytest.approx(np.interp(curve["x"], found["x"], found["y"]))


def test_a_drive_of_many_values_has_no_levels() -> None:
    from hjcamp.known_plants import find_plant

    plant = find_plant("valve_joint")
    signals = dict.fromkeys(plant.states, (0.0, 1.0))
    assert all(
        not one.levels for one in unknowns_of(plant, signals, {name: np.linspace(0, 1, 400) for name in signals}).values()
    )
