"""A log whose first sample is a step: what was given before it is not known, and acts late."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY

CIRCUIT = '''
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Circuit(Plant):
    r"""A resistor charges a capacitor.

    .. math:: C \\dot v = (u - v)/R
    """

    voltage = State("V", typical=1.0)
    source = Input("V")
    resistance = Parameter("V/A", 37e3, (1e3, 5e5), base=True)
    capacitance = Parameter("A*s/V", 1e-6)
    adc_v = Measured("adc", of="voltage")
    period = 0.0064

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Rates."""
        u = actuator(drive.source)
        rate.voltage = store((u - state.voltage) / parameter.resistance, capacity=parameter.capacitance)
        adc = sensor(state.voltage)
'''
TRUE, LATE, PERIOD, SAMPLES = 40e3, 1.7 * 0.0064, 0.0064, 96


def step(level: float, seed: int) -> TestLog:
    """Return a log that begins as the source is switched on; the circuit follows ``LATE`` after it, in closed form."""
    time = np.arange(SAMPLES) * PERIOD
    voltage = level * -np.expm1(-np.maximum(time - LATE, 0.0) / (TRUE * 1e-6))
    noisy = voltage + 0.004 * np.random.default_rng(seed).standard_normal(SAMPLES)
    metadata = {PLANT_KEY: "circuit", PERIOD_KEY: repr(PERIOD), "condition": f"{level}"}
    return TestLog({"time_s": time, "source_v": np.full(SAMPLES, level), "adc_v": noisy}, metadata)


def test_a_log_that_begins_at_a_step_tells_the_base(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "circuit.py").write_text(CIRCUIT)
    found = calibrated(measured_tests([step(1.0 + k, k) for k in range(4)]), {}, unknowns=False).base.fitted.candidate.base
    assert found["resistance"] == pytest.approx(TRUE, rel=0.01)
