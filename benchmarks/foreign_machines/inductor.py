"""A coil with a core, fed by an amplifier: 20 kHz would be usual, here 5 ms and a large coil."""

from math import tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, multisine, read

PERIOD = 0.005
PLANT = '''"""A large coil on an amplifier; the current is measured over a shunt."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Inductor(Plant):
    r"""Faraday and Ohm.

    .. math:: L \\dot i = u - R i
    """

    current = State("A", typical=2.0)

    voltage = Input("V", typical=10.0, text="set point of the amplifier")

    inductance = Parameter("V*s/A", @inductance@, (1e-3, 10.0), "log-uniform", base=True, text="inductance of the coil")
    resistance = Parameter("V/A", @resistance@, (0.1, 100.0), "log-uniform", base=True, text="coil and shunt")

    period = 0.005
    current_a = Measured("shunt", of="current")

    @staticmethod
    def equations(state, parameter, drive, rate):
        u = actuator(drive.voltage)
        rate.current = store(u - parameter.resistance * state.current, capacity=parameter.inductance)
        shunt = sensor(state.current)
'''
# A coil with a time constant of about 60 ms: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "resistance": (3.0, 5.0), "inductance": (0.18, 0.32), "noise": (0.002, 0.01),
    "core": 0.0, "limit": 1e9, "gap": 0.0, "warming": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels and a multisine, up to about 15 V."""
    wanted = 4.0 * multisine(course, count, PERIOD, 0.15, 8.0) + levels(course, count, 40, 300, -7.0, 7.0)
    wanted = np.round(wanted, 3)

    def rate(x: list[float], u: float) -> list[float]:
        real = v["limit"] * tanh(u / v["limit"]) if v["limit"] < 1e8 else u
        real -= v["gap"] * tanh(u / max(0.5 * v["gap"], 1e-9))  # crossover of a push-pull stage
        inductance = v["inductance"] * ((1 - v["core"]) + v["core"] / (1 + (x[0] / 2.0) ** 4))
        resistance = v["resistance"] * (1 + v["warming"] * x[1])
        return [(real - resistance * x[0]) / inductance, (x[0] ** 2 / 4.0 - x[1]) / 6.0]

    states, volts = march(rate, [0.0, 0.0], PERIOD, count, lambda k, x: float(wanted[k]), 6)
    return {"t_s": np.arange(count) * PERIOD, "u_V": volts, "i_A": read(states[:, 0], 20 / 4096, v["noise"], chance)}


MACHINE = Machine(
    "inductor", PLANT, ("inductance", "resistance"), RIG, measure,
    {"time_s": "t_s", "voltage_v": "u_V", "current_a": "i_A"}, (6000, 2500),
    (
        Form("saturation", "tanh", lambda v, s, r: {"limit": r.uniform(13.0, 16.0) / s}, ("saturation",), False),
        Form("dead_band", "crossover", lambda v, s, r: {"gap": s * r.uniform(0.5, 0.9)}, ("dead_band",), False),
        Form("core", "iron", lambda v, s, r: {"core": s * r.uniform(0.3, 0.6)}, drivers=("level",)),
        Form("warming", "copper", lambda v, s, r: {"warming": s * r.uniform(0.1, 0.2)}, drivers=("time", "level")),
    ),
)  # fmt: skip
