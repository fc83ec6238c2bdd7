"""A hydraulic accumulator: a pump fills it, a valve empties it, a gauge reads its pressure."""

from math import sqrt

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, read

PERIOD = 0.05
PLANT = '''"""A bladder accumulator between a pump and a valve; the oil's pressure is that of the gas."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class Accumulator(Plant):
    r"""Gas at one temperature, and an orifice.

    .. math:: \\dot p = \\frac{p^2}{A}\\,(q - K s \\sqrt{p}), \\quad A = p_0 V_0
    """

    pressure = State("Pa", typical=8e6, low=1e5)

    pump = Input("m^3/s", typical=2e-4, text="flow of the pump; the logs hold it as pump_l_per_min")
    valve = Input("1", typical=0.5, text="opening of the valve")

    gas = Parameter("Pa*m**3", @gas@, (1e2, 1e6), "log-uniform", base=True, text="pressure times volume of the gas")
    orifice = Parameter("m^3/s/Pa**0.5", @orifice@, (1e-10, 1e-5), "log-uniform", base=True, text="conductance of the valve")

    period = 0.05
    pressure_bar = Measured("gauge", of="pressure")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(drive.pump)
        outflow = path(parameter.orifice * drive.valve * sqrt(state.pressure), upstream=state.pressure)
        rate.pressure = store(inflow - outflow, stiffness=state.pressure * state.pressure / parameter.gas)
        gauge = sensor(state.pressure)
'''
# An accumulator of one or two litres: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "gas": (5e3, 9e3), "orifice": (1.2e-7, 1.7e-7), "noise": (3e3, 1e4),
    "gap": 0.0, "warm": 0.0, "snubber": 0.0, "slip": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: the pump at levels; the valve opens the more, the more the pressure is over 90 bar (not all of it)."""
    flow = np.round(levels(course, count, 30, 200, 2.0, 20.0), 2) / 6e4
    wanted = levels(course, count, 60, 400, 5e6, 1.3e7)
    opening = np.empty(count)
    now = {"valve": 0.3}

    def drive(k: int, x: list[float]) -> float:
        now["valve"] = opening[k] = round(float(np.clip(0.35 + (x[0] - wanted[k]) / 8e6, 0.0, 1.0)), 3)
        return float(flow[k])

    def rate(x: list[float], u: float) -> list[float]:
        oil, warmth, first, second = x  # warmth: how much of its temperature the gas has more than the wall
        leak = v["gap"] * oil * (oil / 8e6) ** 2  # the gap widens under pressure
        net = u * (1 - v["slip"] * (oil / 8e6) ** 3) - v["orifice"] * now["valve"] * sqrt(max(oil, 0.0)) - leak
        pace = net * oil / (v["gas"] * (1 + warmth))  # of the volume, relative
        heat = (v["warm"] * pace * (1 + warmth) - warmth / 6.0) if v["warm"] else 0.0
        lag = v["snubber"]
        seen = [(oil - first) / lag, (first - second) / lag] if lag else [0.0, 0.0]
        return [oil * pace + (oil * heat / (1 + warmth)), heat, *seen]

    states, pump = march(rate, [8e6, 0.0, 8e6, 8e6], PERIOD, count, drive, 4)
    gauge = read(states[:, 3 if v["snubber"] else 0], 1e4, v["noise"], chance)
    return {"t_s": np.arange(count) * PERIOD, "q_lpm": 6e4 * pump, "valve_pc": 100 * opening, "p_bar": gauge / 1e5}


MACHINE = Machine(
    "accumulator", PLANT, ("gas", "orifice"), RIG, measure,
    {"time_s": "t_s", "pump_m3_per_s": {"column": "q_lpm", "unit": "L/min"},
     "valve_ratio": {"column": "valve_pc", "unit": "%"}, "pressure_bar": "p_bar"}, (5000, 2000),
    (
        Form("leakage", "widening", lambda v, s, r: {"gap": s * r.uniform(1e-12, 2e-12)}, ("leakage",), False),
        Form("sensor_lag", "snubber", lambda v, s, r: {"snubber": s * r.uniform(0.1, 0.2)}, ("sensor_lag",), False),
        # small changes of a gas that warms and cools again are a store beside one, of the same time
        Form("gas", "warming", lambda v, s, r: {"warm": min(0.4, 0.3 * s)}, drivers=("flow", "level"), similar=("second_store",)),
        Form("slip", "pump", lambda v, s, r: {"slip": s * r.uniform(0.05, 0.1)}, drivers=("level",), similar=("leakage",)),
    ),
)  # fmt: skip
