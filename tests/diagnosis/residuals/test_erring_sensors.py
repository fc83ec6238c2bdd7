"""A sensor's error on a plant that falls by itself: each window begins where the sensor, errors and all, reads."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.calibration.prediction_windows import power_of
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.residuals.initial_states import erring_sensors
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

PERIOD, SMALL, OFFSET, MAGNET, MASS = 2e-3, 20, 1e-3, 9e-5, 0.068
SENSORS = ("sensor_gain", "sensor_lag", "sensor_offset")
MAGNET_FILE = '''
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Magnet(Plant):
    r"""A ball under a magnet.

    .. math:: m \\ddot z = m g - K \\frac{i^2}{z^2}
    """

    gap = State("m", typical=0.01, low=0.001)
    velocity = State("m/s", typical=0.02)
    current = Input("A", typical=1.0)
    mass = Parameter("kg", 0.068)
    magnet = Parameter("N*m**2/A**2", 1.2e-4, (1e-6, 1e-3), "log-uniform", base=True)
    period = 0.002
    gap_mm = Measured("photocell", of="gap")
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, drive, rate):
        i = actuator(drive.current)
        load = outside("N")
        pull = parameter.magnet * i * i / (state.gap * state.gap)
        rate.gap = state.velocity
        rate.velocity = body(parameter.mass * 9.81 + load - pull, mass=parameter.mass, load=load, position=state.gap)
        photocell = sensor(state.gap)
'''


@functools.cache
def held_ball(seconds: float = 12.0) -> TestLog:
    """Return a log of a ball that another loop holds along sines, read 1 mm too far, solved by small steps."""
    generator = np.random.default_rng(8)
    time = np.arange(round(seconds / PERIOD)) * PERIOD
    wanted = 0.009 + 1.5e-3 * np.sin(1.3 * time) + 5e-4 * np.sin(4.1 * time + 1.0)
    z, v, h = float(wanted[0]), 0.0, PERIOD / SMALL
    gaps, currents = np.empty(len(time)), np.empty(len(time))
    for k, place in enumerate(wanted.tolist()):
        gaps[k] = z + OFFSET + 1e-6 * generator.standard_normal()
        currents[k] = i = max(z * np.sqrt(MASS * 9.81 / MAGNET) * (1.0 + 260.0 * (z - place) + 6.0 * v), 0.0)
        pull = MAGNET / MASS * i * i
        for _ in range(SMALL):
            before = 9.81 - pull / (z * z)
            z += h * (v + 0.5 * h * before)
            v += 0.5 * h * (before + 9.81 - pull / (z * z))
    columns = {"time_s": time, "gap_mm": gaps * 1e3, "current_a": currents}
    return TestLog(columns, {"plant": "magnet", "period_s": str(PERIOD), "condition": "held"})


@pytest.fixture
def measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/magnet.py").write_text(MAGNET_FILE, encoding="utf-8")
    return measured_tests([held_ball()])


def test_the_offset_of_a_sensor_is_named_where_the_ball_falls_by_itself(measured: Measured) -> None:
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in ("constant_force", "cubic_spring", "sensor_gain", "sensor_offset", "spring")}
    analysis = calibrated(measured, chosen)
    found = decided(analysis)
    assert found.effects == ("sensor_offset",)
    own = found.model.fitted.candidate
    assert own.effects["sensor_offset"]["offset"] == pytest.approx(OFFSET, rel=0.05)
    assert own.base["magnet"] == pytest.approx(MAGNET, rel=0.02)


def test_windows_begin_where_the_sensor_reads_with_its_errors(measured: Measured) -> None:
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in SENSORS}, unknowns=False)
    windows, base = analysis.windows, analysis.base.fitted.candidate
    first = slice(None, None, windows.layout.width)
    plain = windows.readings(base)
    for gain in (0.02, 1.4):  # 1 - 1.4 is below any gap
        wrong = windows.readings(base.with_effect("sensor_gain", {"gain_error": gain}))
        assert np.allclose(wrong[0][first], plain[0][first], rtol=1e-9)
        assert np.allclose(wrong[1][first, 0], plain[1][first, 0] / (1.0 + gain), rtol=1e-9)
    # what has a memory begins as the plant does
    assert set(erring_sensors(measured.plant, library)["gap_mm"]) >= {"sensor_gain", "sensor_offset", "sensor_drift"}
    assert "sensor_lag" not in erring_sensors(measured.plant, library)["gap_mm"]
    late = windows.readings(base.with_effect("sensor_lag", {"lag": 0.004, "dead_share": 0.0}))
    assert isinstance(windows, Windows) and np.array_equal(late[1][first], plain[1][first])


def test_windows_are_no_longer_though_a_path_that_has_left_grows_no_more(
    measured: Measured, monkeypatch: pytest.MonkeyPatch
) -> None:
    # over 23, 46 and 93 samples the start grows 3.5, 7 and, where the ball has hit the magnet, 0 times
    widths = {23: 3.5, 46: 7.0, 93: 0.0}
    monkeypatch.setattr(Windows, "growth", lambda self, candidate: widths[self.layout.width])
    assert calibrated(measured, {}, unknowns=False, width=93).windows.layout.width == 23
    widths[46] = 3.0
    assert calibrated(measured, {}, unknowns=False, width=93).windows.layout.width == 46
    widths[23] = 2.0
    assert calibrated(measured, {}, unknowns=False, width=93).windows.layout.width == 93
    assert power_of(64, 1) == pytest.approx(63.0 / 31.0) and power_of(64, 0) == 1.0


def test_balances_of_the_true_model_are_noise_though_the_base_is_far_off(measured: Measured) -> None:
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in SENSORS}, unknowns=False)
    assert abs(analysis.base.fitted.candidate.base["magnet"] / MAGNET - 1.0) > 0.1
    true = analysis.base.fitted.candidate.with_base({"magnet": MAGNET, "delay.current": 0.0})
    true = true.with_effect("sensor_offset", {"offset": OFFSET})
    own = analysis.search.begun_at(true, None)
    columns = analysis.channels.columns[1]

    def rms() -> float:
        return float(np.sqrt(np.mean(own.features(true)[:, columns] ** 2)))

    own.move_starts(true, rounds=4)
    assert 0.4 < rms() < 1.3
    # across seams that are far apart nothing is known of what smoothing makes of the base's path, here of all
    usual = analysis.base.place.usual
    assert usual is not None and np.mean(np.all(usual.estimated == usual.simulated, axis=1)) > 0.9
    assert own.usual is not None and np.mean(np.all(own.usual.estimated == own.usual.simulated, axis=1)) < 0.1
    own.balances = replace(own.balances, usual=usual) if own.balances else None
    own.usual = None
    assert rms() < 2.0
