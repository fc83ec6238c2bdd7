"""A state that nothing measures is found where it is, however far from 0 and from what is typical by the plant's file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import cont2discrete

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.records.log import TestLog

CORE, SHELL, JOINT, LOSS, OUTSIDE, PERIOD, NOISE = 40.0, 90.0, 2.0, 1.5, 320.0, 1.0, 0.02
PLANT = '''"""A heater in a shell."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Shell(Plant):
    """Two stores of heat, the inner one unseen."""

    core = State("K", typical=1.0)
    shell = State("K", typical=350.0, low=1.0)
    power = Input("W", typical=50.0)
    core_capacity = Parameter("J/K", 55.0, (1.0, 1e4), "log-uniform", base=True)
    shell_capacity = Parameter("J/K", 70.0, (1.0, 1e4), "log-uniform", base=True)
    joint = Parameter("W/K", 2.0)
    loss = Parameter("W/K", 1.2, (0.01, 100.0), "log-uniform", base=True)
    outside = Parameter("K", 320.0)
    period = 1.0
    shell_k = Measured("probe", of="shell")

    @staticmethod
    def equations(state, parameter, drive, rate):
        heat = actuator(drive.power)
        across = parameter.joint * (state.core - state.shell)
        away = parameter.loss * (state.shell - parameter.outside)
        rate.core = store(heat - across, capacity=parameter.core_capacity)
        rate.shell = store(across - away, capacity=parameter.shell_capacity)
        probe = sensor(state.shell)
'''


@pytest.fixture
def shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Measured, np.ndarray]:
    """The log of a shell that is heated in steps, solved exactly, with its core's temperature."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "shell.py").write_text(PLANT, encoding="utf-8")
    generator, count = np.random.default_rng(4), 3200
    power = np.repeat(generator.uniform(0.0, 100.0, count // 40), 40)
    rates = np.array([[-JOINT / CORE, JOINT / CORE], [JOINT / SHELL, -(JOINT + LOSS) / SHELL]])
    step, push, *_ = cont2discrete((rates, np.array([[1.0 / CORE], [0.0]]), np.eye(2), np.zeros((2, 1))), PERIOD)
    state, shown = np.array([60.0, 25.0]), np.empty((count, 2))
    for k in range(count):
        shown[k] = OUTSIDE + state
        state = step @ state + push[:, 0] * power[k]
    columns = {
        "time_s": PERIOD * np.arange(count),
        "power_w": power,
        "shell_k": shown[:, 1] + NOISE * generator.standard_normal(count),
    }
    return measured_tests([TestLog(columns, {"plant": "shell", "period_s": str(PERIOD), "condition": "steps"})]), shown[:, 0]


def test_a_state_that_nothing_measures_is_found_far_from_zero(shell: tuple[Measured, np.ndarray]) -> None:
    measured, core = shell
    analysis = calibrated(measured, {}, unknowns=False)
    windows, base = analysis.windows, analysis.base.fitted.candidate.base
    # two pairs of capacities give the shell the same course; their product is one
    assert base["core_capacity"] * base["shell_capacity"] == pytest.approx(CORE * SHELL, rel=0.02)
    assert base["loss"] == pytest.approx(LOSS, rel=0.02)
    assert not windows.layout.memory
    begun = windows.starts[:, 0] - core[: len(windows.starts) * windows.layout.width : windows.layout.width]
    assert np.median(np.abs(begun)) < 5.0
    assert np.sqrt(np.mean(analysis.base.features**2)) < 1.3
