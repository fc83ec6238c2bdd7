"""Of a state that readings tell in more than one place the equations say, from the start of a test on, in which it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.records.log import TestLog

PERIOD, GAIN, LAG, NOISE = 0.02, 8.0, 4.0, 0.05
PLANT = '''"""A fan whose counter does not tell which way it turns."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Fan(Plant):
    """Its speed follows the voltage."""

    period = 0.02
    speed = State("rad/s", typical=5.0, start="unknown")
    voltage = Input("V", typical=1.0)
    gain = Parameter("rad/(V*s)", GAIN, (0.1, 100.0), "log-uniform", base=True)
    lag = Parameter("s", LAG, (0.01, 100.0), "log-uniform", base=True)
    speed_rad_per_s = Measured("counter")

    @staticmethod
    def equations(state, parameter, drive, rate):
        wanted = actuator(parameter.gain * drive.voltage)
        rate.speed = store(wanted - state.speed, capacity=parameter.lag)
        counter = sensor(abs(state.speed))
'''


def fan(folder: Path, off: float) -> Measured:
    """Return two tests of the fan, solved exactly; the plant's file declares its lag ``off`` times too large."""
    (folder / "plants").mkdir()
    declared = PLANT.replace("GAIN", f"{GAIN / 1.2}").replace("LAG", f"{LAG * off}")
    (folder / "plants" / "fan.py").write_text(declared, encoding="utf-8")
    logs, kept = [], np.exp(-PERIOD / LAG)
    for seed in (1, 2):
        generator = np.random.default_rng(seed)
        volts = np.repeat(generator.uniform(-2.0, 2.0, 20), 50)
        speed = np.zeros(len(volts))
        for k in range(len(volts) - 1):
            speed[k + 1] = kept * speed[k] + (1.0 - kept) * GAIN * volts[k]
        shown = np.abs(speed) + NOISE * generator.standard_normal(len(volts))
        columns = {"time_s": np.arange(len(volts)) * PERIOD, "speed_rad_per_s": shown, "voltage_v": volts}
        logs.append(TestLog(columns, {"plant": "fan", "period_s": str(PERIOD), "condition": f"test {seed}"}))
    return measured_tests(logs)


@pytest.mark.parametrize("off", [1.3, 3.0])
def test_the_sign_of_a_speed_of_which_the_size_is_measured_follows_from_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    monkeypatch.chdir(tmp_path)
    base = calibrated(fan(tmp_path, off), {}, unknowns=False, width=16).base
    found = base.fitted.candidate.base
    assert found["gain"] == pytest.approx(GAIN, rel=0.01) and found["lag"] == pytest.approx(LAG, rel=0.01)
    assert np.sqrt(np.mean(base.features**2)) < 1.2
