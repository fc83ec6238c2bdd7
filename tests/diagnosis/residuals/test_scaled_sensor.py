"""A sensor that shows a state in another scale, and one that shows a rate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, MASS, PERIOD, measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import MOST_DELAY, measured_tests
from hjcamp.diagnosis.residuals.initial_states import estimated
from hjcamp.records.log import TestLog

TURNS, ZERO = 40.0, 0.5


def changed(axis: Path, *edits: tuple[str, str]) -> None:
    path = axis / "plants" / "axis.py"
    text = path.read_text()
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


def test_a_state_begins_where_a_sensor_of_another_scale_says(axis: Path) -> None:
    """An encoder that reads 40 times the travel, from half a metre on."""
    changed(axis, ("sensor(state.position)", "sensor(40.0 * state.position + 0.5)"))
    log = measured_log(seconds=8.0)
    places = log.columns["position_m"][MOST_DELAY:]
    turned = TestLog(log.columns | {"position_m": TURNS * log.columns["position_m"] + ZERO}, log.metadata)
    measured = measured_tests([turned])
    states, error = estimated(measured)
    assert np.abs(states[0][:, 0] - places).max() < 1e-9 and error[0] == pytest.approx(measured.noise[0] / TURNS)
    speed = np.gradient(places, PERIOD)
    assert np.abs(states[0][50:-50, 1] - speed[50:-50]).max() < 0.02 * np.abs(speed).max()
    base = calibrated(measured, {}, unknowns=False).base.fitted.candidate.base
    assert base["mass"] == pytest.approx(MASS, rel=0.02) and base["coulomb"] == pytest.approx(COULOMB, rel=0.05)


def test_an_accelerometer_is_analysed(axis: Path) -> None:
    changed(
        axis,
        ("encoder = sensor(state.position)", "encoder = sensor(state.position)\n        seen = sensor(rate.velocity)"),
        (
            'position_m = Measured("encoder", of="position")',
            'position_m = Measured("encoder", of="position")\n    acceleration_m_per_s2 = Measured("seen", noise=0.02)',
        ),
    )
    log = measured_log(seconds=8.0)
    pace = np.gradient(np.gradient(log.columns["position_m"], PERIOD), PERIOD)
    smooth = np.convolve(pace, np.ones(5) / 5.0, mode="same")
    with_it = TestLog(log.columns | {"acceleration_m_per_s2": smooth}, log.metadata)
    base = calibrated(measured_tests([with_it]), {}, unknowns=False).base.fitted.candidate.base
    assert base["mass"] == pytest.approx(MASS, rel=0.05)
