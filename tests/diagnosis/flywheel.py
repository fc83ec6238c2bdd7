"""A motor with a flywheel behind a lag, solved exactly from sample to sample: it shares no code with the program."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete

from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.records.log import TestLog

GAIN, INERTIA, VISCOUS, LAG, PERIOD, NOISE = 0.02, 1.0e-3, 4e-3, 0.15, 0.01, 0.02
PLANT = '''"""A motor with a flywheel."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Motor(Plant):
    """A motor turns a flywheel."""

    speed = State("rad/s", typical=8.0)
    voltage = Input("V", typical=3.0)
    gain = Parameter("N*m/V", 0.02)
    inertia = Parameter("kg*m**2", 1.2e-3, (1e-6, 1e-1), "log-uniform", base=True)
    viscous = Parameter("N*m*s", 5e-3, (0.0, 0.1), base=True)
    period = 0.01
    speed_rad_per_s = Measured("tacho", of="speed")

    @staticmethod
    def equations(state, parameter, drive, rate):
        command = actuator(drive.voltage)
        load = outside("N*m")
        push = parameter.gain * command + load - parameter.viscous * state.speed
        rate.speed = body(push, mass=parameter.inertia, load=load)
        tacho = sensor(state.speed)
'''


def behind_a_lag(band: float = 0.0) -> Measured:
    """Return two logs, at rest where the voltage is on already; ``band`` (V) lacks of it before the lag. The plant's file goes here."""
    Path("plants").mkdir()
    Path("plants/motor.py").write_text(PLANT, encoding="utf-8")
    generator, count = np.random.default_rng(3), 1200
    rates = np.array([[-1.0 / LAG, 0.0], [GAIN / INERTIA, -VISCOUS / INERTIA]])
    step, push, *_ = cont2discrete((rates, np.array([[1.0 / LAG], [0.0]]), np.eye(2), np.zeros((2, 1))), PERIOD)
    logs = []
    for name in ("a", "b"):
        voltage = np.repeat(generator.uniform(-3.0, 3.0, count // 40), 40)
        bent: NDArray[np.float64] = np.sign(voltage) * np.maximum(np.abs(voltage) - band, 0.0)
        state, shown = np.zeros(2), np.empty(count)
        for k in range(count):
            shown[k] = state[1]
            state = step @ state + push[:, 0] * bent[k]
        shown += NOISE * generator.standard_normal(count)
        columns = {"time_s": PERIOD * np.arange(count), "voltage_v": voltage, "speed_rad_per_s": shown}
        logs.append(TestLog(columns, {"plant": "motor", "period_s": str(PERIOD), "condition": name}))
    return measured_tests(logs)
