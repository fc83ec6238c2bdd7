"""A heated block with one thermometer, a sample each 5 s."""

from math import pi, sin

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, read

PERIOD, AMBIENT = 5.0, 295.0
PLANT = '''"""A heated block; a thermometer in it; the room is at 22 degrees."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, store


class Oven(Plant):
    r"""Heat that is stored is heat fed less heat lost.

    .. math:: C \\dot \\vartheta = P - h\\,\\vartheta

    with the temperature above that of the room.
    """

    excess = State("K", typical=60.0)

    power = Input("W", typical=100.0, text="electric power of the heater")

    capacity = Parameter("W*s/K", @capacity@, (10.0, 1e5), "log-uniform", base=True, text="heat capacity")
    transfer = Parameter("W/K", @transfer@, (0.01, 100.0), "log-uniform", base=True, text="heat loss for one kelvin")

    period = 5.0
    excess_k = Measured("thermometer", of="excess")

    @staticmethod
    def equations(state, parameter, drive, rate):
        heat = actuator(drive.power)
        loss = path(parameter.transfer * state.excess, upstream=state.excess)
        rate.excess = store(heat - loss, capacity=parameter.capacity)
        thermometer = sensor(state.excess)
'''
# A block with a time constant of some ten minutes: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "capacity": (700.0, 1100.0), "transfer": (1.2, 1.8), "noise": (0.03, 0.08),
    "power": 0.0, "radiation": 0.0, "sheath": 0.0, "room": 0.0, "room_period": 1.0, "room_phase": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels of the heater's power, up to 200 W."""
    watts = np.round(np.maximum(levels(course, count, 20, 140, -60.0, 200.0), 0.0), 1)
    start = course.uniform(0.0, 60.0) + chance.normal(0.0, 0.5)

    def rate(x: list[float], u: float) -> list[float]:
        kelvin = AMBIENT + x[0]
        room = v["room"] * sin(2 * pi * x[3] / v["room_period"] + v["room_phase"])
        loss = v["transfer"] * (x[0] - room) * (max(x[0], 0.1) / 60.0) ** v["power"]
        loss += v["radiation"] * 5.67e-8 * (kelvin**4 - AMBIENT**4)
        lag = max(v["sheath"], 1e-3)
        seen = [(x[0] - x[1]) / lag, (x[1] - x[2]) / lag] if v["sheath"] else [0.0, 0.0]
        return [(u - loss) / v["capacity"], *seen, 1.0]

    states, power = march(rate, [start, start, start, 0.0], PERIOD, count, lambda k, x: float(watts[k]), 4)
    excess = states[:, 2 if v["sheath"] else 0]
    return {"t_s": np.arange(count) * PERIOD, "P_W": power, "T_C": read(excess + AMBIENT - 273.0, 0.1, v["noise"], chance)}


MACHINE = Machine(
    "oven", PLANT, ("capacity", "transfer"), RIG, measure,
    {"time_s": "t_s", "power_w": "P_W", "excess_k": {"column": "T_C", "unit": "K", "offset": -22.0}}, (2400, 900),
    (
        Form("flow_exponent", "air", lambda v, s, r: {"power": s * r.uniform(0.2, 0.33)}, ("flow_exponent",), similar=("leakage",)),
        Form("sensor_lag", "sheath", lambda v, s, r: {"sheath": s * r.uniform(8.0, 15.0)}, ("sensor_lag",), False,
             similar=("command_delay",)),
        Form("radiation", "fourth_power", lambda v, s, r: {"radiation": s * r.uniform(0.06, 0.12), "transfer": 0.5 * v["transfer"]},
             drivers=("level",), similar=("flow_exponent", "leakage")),
        Form("room", "day", lambda v, s, r: {"room": s * r.uniform(3.0, 5.0), "room_period": r.uniform(3000.0, 6000.0),
             "room_phase": r.uniform(0, 6)}, drivers=("time",), similar=("sensor_drift",)),
    ),
)  # fmt: skip
