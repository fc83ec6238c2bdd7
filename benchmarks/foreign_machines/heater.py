"""A heater on a plate with a thermometer of its own time; nobody measures the heater itself. A sample each 2 s."""

from math import pi, sin

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, read

PERIOD, ROOM = 2.0, 296.0
PLANT = '''"""A small heater; its thermometer follows it late."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, store


class Heater(Plant):
    r"""Two temperatures above that of the room; the thermometer's is measured.

    .. math:: C \\dot h = P - g\\,h, \\quad \\dot s = r\\,(h - s)
    """

    core = State("K", typical=30.0, start="unknown")
    probe = State("K", typical=30.0)

    power = Input("W", typical=0.5, text="electric power of the transistor")

    capacity = Parameter("W*s/K", @capacity@, (0.1, 1e3), "log-uniform", base=True, text="heat capacity of the heater")
    transfer = Parameter("W/K", @transfer@, (1e-3, 1.0), "log-uniform", base=True, text="heat loss for one kelvin")
    pace = Parameter("1/s", @pace@, (1e-3, 1.0), "log-uniform", base=True, text="one over the time of the thermometer")

    period = 2.0
    rise_k = Measured("thermometer", of="probe")

    @staticmethod
    def equations(state, parameter, drive, rate):
        heat = actuator(drive.power)
        loss = path(parameter.transfer * state.core, upstream=state.core)
        rate.core = store(heat - loss, capacity=parameter.capacity)
        rate.probe = parameter.pace * (state.core - state.probe)
        thermometer = sensor(state.probe)
'''
# A transistor on a plate, some 150 s slow, and its thermometer, some 20 s: what is drawn, and what is there where nothing hides.
RIG = {
    "capacity": (4.0, 7.0), "transfer": (0.03, 0.05), "pace": (0.035, 0.07), "noise": (0.02, 0.06),
    "radiation": 0.0, "limit": 1e9, "draught": 0.0, "draught_period": 1.0, "threshold": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels of the power, up to 2.2 W."""
    watts = np.round(np.maximum(levels(course, count, 15, 120, -0.6, 2.2), 0.0), 2)
    start = course.uniform(0.0, 20.0) + chance.normal(0.0, 0.2)

    def rate(x: list[float], u: float) -> list[float]:
        kelvin = ROOM + x[0]
        loss = v["transfer"] * x[0] * (1 + v["draught"] * sin(2 * pi * x[2] / v["draught_period"]))
        loss += v["radiation"] * 5.67e-8 * (kelvin**4 - ROOM**4)
        real = u / (1 + (u / v["limit"]) ** 4) ** 0.25 if v["limit"] < 1e8 else u
        real = max(real - v["threshold"], 0.0)
        return [(real - loss) / v["capacity"], v["pace"] * (x[0] - x[1]), 1.0]

    states, power = march(rate, [start, start, 0.0], PERIOD, count, lambda k, x: float(watts[k]), 4)
    rise = read(states[:, 1], 0.05, v["noise"], chance)
    return {"t_s": np.arange(count) * PERIOD, "P_W": power, "rise_K": rise}


MACHINE = Machine(
    "heater", PLANT, ("capacity", "transfer", "pace"), RIG, measure,
    {"time_s": "t_s", "power_w": "P_W", "rise_k": "rise_K"}, (2400, 1200),
    (
        Form("saturation", "supply", lambda v, s, r: {"limit": r.uniform(1.5, 2.0) / s}, ("saturation",), False),
        Form("dead_band", "threshold", lambda v, s, r: {"threshold": s * r.uniform(0.1, 0.2)}, ("dead_band",),
             similar=("sensor_offset",)),
        Form("radiation", "fourth_power", lambda v, s, r: {"radiation": s * r.uniform(0.0012, 0.0025), "transfer": 0.6 * v["transfer"]},
             drivers=("level", "upstream"), similar=("flow_exponent", "leakage", "overflow")),
        Form("draught", "slow", lambda v, s, r: {"draught": s * r.uniform(0.15, 0.3), "draught_period": r.uniform(900.0, 2000.0)},
             drivers=("time",), similar=()),
    ),
)  # fmt: skip
