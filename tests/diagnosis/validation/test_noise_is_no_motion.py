"""Readings that differ by no more than their noise are no motion: nothing is told from it, and nothing can be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from asked import analysed
from flywheel import GAIN, INERTIA, PERIOD, PLANT, VISCOUS

from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.data.repeatability import MOTION_ORDERS, moves
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.validation.kernel_regression import regression_of
from hjcamp.records.log import TestLog

NOISE = 0.02


def turning(voltage: float, swing: float, seed: int = 1) -> Measured:
    """Return a log of a motor at a voltage that swings slowly (V), long after it was switched on."""
    Path("plants").mkdir(exist_ok=True)
    Path("plants/motor.py").write_text(PLANT, encoding="utf-8")
    given = voltage + swing * np.sin(2.0 * np.pi * 0.2 * PERIOD * np.arange(1500))
    kept, now, speed = np.exp(-VISCOUS / INERTIA * PERIOD), GAIN / VISCOUS * voltage, np.empty(len(given))
    for k, one in enumerate(given):
        speed[k] = now
        now = kept * now + (1.0 - kept) * GAIN / VISCOUS * one
    speed += NOISE * np.random.default_rng(seed).standard_normal(len(given))
    columns = {"time_s": PERIOD * np.arange(len(given)), "voltage_v": given, "speed_rad_per_s": speed}
    return measured_tests([TestLog(columns, {"plant": "motor", "period_s": str(PERIOD)})])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_of_a_motor_that_only_makes_noise_nothing_can_be_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    monkeypatch.chdir(tmp_path)
    analysis = analysed(turning(2.0, 0.0, seed), ["constant_force"])
    layout = analysis.windows.layout
    assert not moves(layout).any()
    found = decided(analysis)
    assert found.word == "cannot_tell" and found.lacking == (
        "nothing that is measured changes in these tests by more than its noise",
    )
    # a regression has nothing to go by, and leaves all
    left = regression_of(layout, analysis.base.features, analysis.search.blocks, layout.readings)
    np.testing.assert_allclose(left.features, analysis.base.features[left.rows])


def test_a_slow_swing_far_above_the_noise_is_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis = analysed(turning(2.0, 0.5), ["constant_force"])
    layout = analysis.windows.layout
    assert moves(layout)[0] and moves(layout)[MOTION_ORDERS:].all() and not what_lacks(analysis.measured, layout)
    assert decided(analysis).word == "nothing_missing"
