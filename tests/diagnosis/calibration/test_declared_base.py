"""What logs do not tell of a base stays near what its file declares, and off every bound; what they tell is theirs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from flywheel import PLANT

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.estimation.gauss_newton import Free, promised
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.log import TestLog

GAIN, INERTIA, VISCOUS, PERIOD, NOISE = 0.02, 1e-3, 4e-3, 0.01, 0.02
BASE = {
    'gain = Parameter("N*m/V", 0.02)': 'gain = Parameter("N*m/V", {gain}, (2e-3, 2.0), base=True)',
    '1.2e-3, (1e-6, 1e-1), "log-uniform"': "{inertia}, (1e-4, 1.0)",
    "5e-3, (0.0, 0.1)": "{viscous}, (0.0, 1.0)",
}


def spun(declared: dict[str, float]) -> Measured:
    """Return two logs of a flywheel, exact from sample to sample, and write the plant's file as ``declared``."""
    text = PLANT
    for old, new in BASE.items():
        assert old in text
        text = text.replace(old, new.format(**declared))
    Path("plants").mkdir(exist_ok=True)
    Path("plants/motor.py").write_text(text, encoding="utf-8")
    generator, count, logs = np.random.default_rng(3), 800, []
    kept = math.exp(-VISCOUS / INERTIA * PERIOD)
    for name in ("a", "b"):
        voltage, speed = np.repeat(generator.uniform(-3.0, 3.0, count // 40), 40), np.zeros(count)
        for k in range(1, count):
            speed[k] = kept * speed[k - 1] + (1.0 - kept) * GAIN / VISCOUS * voltage[k - 1]
        shown = speed + NOISE * generator.standard_normal(count)
        columns = {"time_s": PERIOD * np.arange(count), "voltage_v": voltage, "speed_rad_per_s": shown}
        logs.append(TestLog(columns, {"plant": "motor", "period_s": str(PERIOD), "condition": name}))
    return measured_tests(logs)


@pytest.mark.parametrize("off", [0.33, 0.7, 1.4, 3.0])
def test_of_three_parameters_of_which_two_ratios_are_told_each_stays_where_it_surprises_least(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    monkeypatch.chdir(tmp_path)
    declared = {"gain": off * GAIN, "inertia": 1.2 * INERTIA, "viscous": 1.3 * VISCOUS}
    analysis = calibrated(spun(declared), {}, unknowns=False)
    fitted, base = analysis.base.fitted, analysis.base.fitted.candidate.base
    assert base["gain"] / base["inertia"] == pytest.approx(GAIN / INERTIA, rel=0.01)
    assert base["viscous"] / base["inertia"] == pytest.approx(VISCOUS / INERTIA, rel=0.02)
    # all of them by one factor leave the readings as they are: by which is for what is declared
    usual = {one.name: one.surprise(fitted.candidate) for one in fitted.free}
    assert all(abs(usual[name]) < 1.0 for name in declared), usual
    assert promised(fitted) < 0.05


@pytest.mark.parametrize("log", [False, True])
def test_a_surprise_is_in_spreads_and_its_slope_is_its_change(log: bool) -> None:
    one = Free("", "size", 2.0, 0.1, 100.0, log, math.log(3.0) if log else 4.0, 3.0)
    before, after = (
        one.into(Candidate({"size": 9.0}, {}), one.of(Candidate({"size": 9.0}, {})) + step) for step in (0.0, 0.01)
    )
    assert one.surprise(before) == pytest.approx(1.0 if log else 1.5)
    assert one.surprise(after) - one.surprise(before) == pytest.approx(0.01 * one.slope)
