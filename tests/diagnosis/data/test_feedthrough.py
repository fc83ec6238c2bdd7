"""Noise of a sensor that an input reaches at once: the voltage of a cell leaps with its current."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.feedthrough import may_be_late, passed_to
from hjcamp.diagnosis.data.sensor_noise import noise_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.known_plants import find_plant
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY

CELL = '''
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Cell(Plant):
    r"""A cell with one slow part behind its inner resistance.

    .. math:: U = U_0 - R_0 i - v
    """

    slow = State("V", typical=0.05)
    current = Input("A", typical=2.0)
    inner = Parameter("V/A", 0.03, (1e-3, 1.0), base=True)
    outer = Parameter("V/A", 0.02, (1e-3, 1.0), base=True)
    capacity = Parameter("A*s/V", 1e3)
    rest = Parameter("V", 3.7)
    cell_v = Measured("gauge")
    period = 1.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Rates."""
        drawn = actuator(drive.current)
        rate.slow = store(drawn - state.slow / parameter.outer, capacity=parameter.capacity)
        gauge = sensor(parameter.rest - parameter.inner * drawn - state.slow)
'''
NOISE = 1e-3


def test_leaps_that_an_input_passes_on_are_no_noise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "cell.py").write_text(CELL)
    generator = np.random.default_rng(3)
    current = np.repeat(generator.uniform(-4.0, 4.0, 800), 2)
    time = np.arange(len(current)) * 1.0
    slow = np.convolve(current, 0.02 * np.exp(-time / 20.0) / 20.0)[: len(current)]
    volts = 3.7 - 0.03 * current - slow + NOISE * generator.standard_normal(len(current))
    metadata = {PLANT_KEY: "cell", PERIOD_KEY: "1.0", "condition": "drive"}
    measured = measured_tests([TestLog({"time_s": time, "current_a": current, "cell_v": volts}, metadata)])
    assert passed_to(find_plant("cell"), "cell_v") == (0,) and passed_to(find_plant("valve_joint"), "arm_deg") == ()
    assert noise_of(volts) > 5.0 * NOISE
    assert measured.noise[0] == pytest.approx(NOISE, rel=0.15)


def test_what_runs_linearly_is_read_as_it_is_at_each_sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "cell.py").write_text(CELL.replace("typical=2.0)", 'typical=2.0, hold="linear")'))
    generator = np.random.default_rng(4)
    time = np.arange(1600) * 1.0
    current = np.cumsum(generator.uniform(-1.0, 1.0, 1600))
    # straight lines from sample to sample, in closed form: v' = (r i - v) / tau
    tau, slow = 20.0, np.zeros(1600)
    for k in range(1599):
        slope = current[k + 1] - current[k]
        steady = 0.02 * (current[k] - tau * slope)
        slow[k + 1] = steady + 0.02 * slope + (slow[k] - steady) * np.exp(-1.0 / tau)
    volts = 3.7 - 0.03 * current - slow + NOISE * generator.standard_normal(1600)
    columns = {"time_s": time, "current_a": current, "cell_v": volts}
    log = TestLog(columns, {PLANT_KEY: "cell", PERIOD_KEY: "1.0", "condition": "drive"})
    found = calibrated(measured_tests([log]), {}, unknowns=False)
    assert found.base.fitted.candidate.base["inner"] == pytest.approx(0.03, rel=0.005)
    assert np.sqrt(np.mean(found.base.features**2)) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("early", [0.4, -0.7])
def test_what_runs_linearly_may_act_earlier_or_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, early: float) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    linear = CELL.replace("typical=2.0)", 'typical=2.0, hold="linear")')
    (tmp_path / "plants" / "cell.py").write_text(linear)
    # that its sensor reads it at once says when it acts
    assert may_be_late(find_plant("cell")) == ()
    # that of this one does not
    hidden = linear.replace(" - parameter.inner * drawn", "").replace(", (1e-3, 1.0), base=True)", ")", 1)
    hidden = hidden.replace("class Cell", "class SlowCell").replace('"gauge")', '"gauge", noise=1e-4)')
    (tmp_path / "plants" / "slow_cell.py").write_text(hidden)
    assert may_be_late(find_plant("slow_cell")) == ("current",)
    generator = np.random.default_rng(4)
    time, parts, tau = np.arange(1200) * 1.0, 50, 20.0
    current = generator.uniform(-8.0, 8.0, 1200)
    slow, fine = np.zeros(1200), 0.0
    for k in range(1199):
        for given in np.interp(k + (np.arange(parts) + 0.5) / parts + early, time, current):
            fine += (0.02 * given - fine) * (1.0 - np.exp(-1.0 / (parts * tau)))
        slow[k + 1] = fine
    columns = {"time_s": time, "current_a": current, "cell_v": 3.7 - slow + 1e-4 * generator.standard_normal(1200)}
    log = TestLog(columns, {PLANT_KEY: "slow_cell", PERIOD_KEY: "1.0", "condition": "drive"})
    found = calibrated(measured_tests([log]), {}, unknowns=False).base
    assert found.fitted.candidate.base["delay.current"] == pytest.approx(-early, abs=0.02)
    assert found.fitted.candidate.base["outer"] == pytest.approx(0.02, rel=0.02)
    assert np.sqrt(np.mean(found.features**2)) == pytest.approx(1.0, abs=0.15)


def test_an_input_that_no_equation_of_the_plant_contains_is_never_late() -> None:
    # the dither acts on an effect alone; the pump by its rate
    plant = find_plant("pump_joint").room_of("common").PLANT
    assert may_be_late(plant) == ("pump",)
