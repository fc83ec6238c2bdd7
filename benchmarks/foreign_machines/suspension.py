"""A quarter of a car on a shaker: the road is what the shaker reports."""

from math import tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, march, multisine, read

PERIOD = 0.005
PLANT = '''"""A quarter of a car on a shaker; the travel of the strut and that of the tyre are measured."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, contact, outside, sensor


class Suspension(Plant):
    r"""Two masses, strut and tyre.

    .. math:: m_s \\ddot z_s = -F, \\quad m_u \\ddot z_u = F - k_t (z_u - z_r),
        F = k s + c \\dot s + F_c \\,\\mathrm{sign}\\, \\dot s

    with the strut's travel s = z_s - z_u and the wheel's height, all about rest.
    """

    travel = State("m", typical=0.03)
    travel_speed = State("m/s", typical=0.3)
    wheel = State("m", typical=0.02)
    wheel_speed = State("m/s", typical=0.3)

    road = Input("m", typical=0.02, text="height of the shaker's plate; the logs hold it as road_m")

    sprung = Parameter("kg", 300.0, text="quarter of the body, weighed")
    unsprung = Parameter("kg", 40.0, text="wheel and axle, weighed")
    spring = Parameter("N/m", @spring@, (1e3, 1e6), "log-uniform", base=True, text="spring of the strut")
    damper = Parameter("N*s/m", @damper@, (10.0, 1e5), "log-uniform", base=True, text="damper of the strut")
    seal = Parameter("N", @seal@, (0.1, 1e3), "log-uniform", base=True, text="Coulomb friction of the strut")
    tyre = Parameter("N/m", @tyre@, (1e4, 1e7), "log-uniform", base=True, text="stiffness of the tyre")

    period = 0.005
    travel_mm = Measured("strut", of="travel")
    wheel_mm = Measured("laser", of="wheel")

    @staticmethod
    def equations(state, parameter, drive, rate):
        reduced = parameter.sprung * parameter.unsprung / (parameter.sprung + parameter.unsprung)
        tyre_force = parameter.tyre * (drive.road - state.wheel)
        share = reduced / parameter.unsprung
        load = outside("N")
        push = -parameter.spring * state.travel - share * tyre_force + load
        friction = contact(
            state.travel_speed, push=push, coulomb=parameter.seal, viscous=parameter.damper, travel=state.travel, mass=reduced
        )
        rate.travel = state.travel_speed
        rate.travel_speed = (push - friction) / reduced
        rate.wheel = state.wheel_speed
        rate.wheel_speed = (tyre_force + parameter.spring * state.travel + friction) / parameter.unsprung
        strut = sensor(state.travel)
        laser = sensor(state.wheel)
'''
# A small car: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "spring": (1.6e4, 2.4e4), "damper": (1000.0, 1600.0), "seal": (15.0, 40.0),
    "tyre": (1.5e5, 2.1e5), "noise": (2e-5, 1e-4), "uneven": 0.0, "bump": 0.0, "gap": 0.02,
    "valve": 0.0, "lift": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: a road of 0.4 to 12 Hz."""
    slow, fast = multisine(course, count, PERIOD, 0.4, 3.0), multisine(course, count, PERIOD, 3.0, 12.0)
    road = np.round(0.008 * slow + 0.002 * fast, 5)

    def rate(x: list[float], u: float) -> list[float]:
        body, body_speed, wheel, wheel_speed = x
        travel, speed = body - wheel, body_speed - wheel_speed
        damper = v["damper"] * speed * (1 + v["uneven"] * tanh(speed / 0.08))
        damper /= 1 + v["valve"] * abs(speed)
        over = max(abs(travel) - v["gap"], 0.0)
        stop = v["bump"] * over**2 * (1 if travel > 0 else -1)
        strut = v["spring"] * travel + damper + stop + v["seal"] * tanh(speed / 0.002)
        tyre = v["tyre"] * (u - wheel)
        if v["lift"]:
            tyre = max(tyre, -v["lift"])  # beyond its weight a tyre leaves the ground
        return [body_speed, -strut / 300.0, wheel_speed, (strut + tyre) / 40.0]

    states, plate = march(rate, [0.0] * 4, PERIOD, count, lambda k, x: float(road[k]), 10)
    travel, wheel = states[:, 0] - states[:, 2], states[:, 2]
    return {
        "t_s": np.arange(count) * PERIOD,
        "road_mm": 1e3 * plate,
        "strut_mm": 1e3 * read(travel, 2e-5, v["noise"], chance),
        "wheel_mm": 1e3 * read(wheel, 2e-5, v["noise"], chance),
    }


MACHINE = Machine(
    "suspension",
    PLANT,
    ("spring", "damper", "seal", "tyre"),
    RIG,
    measure,
    {"time_s": "t_s", "travel_mm": "strut_mm", "wheel_mm": "wheel_mm", "road_m": {"column": "road_mm", "unit": "mm"}},
    (6000, 2500),
    (
        Form("viscous_asymmetry", "smooth", lambda v, s, r: {"uneven": s * r.uniform(0.3, 0.5)}, ("viscous_asymmetry",), False),
        Form("valve", "digressive", lambda v, s, r: {"valve": s * r.uniform(2.0, 4.0)}, drivers=("velocity",)),
        Form("bump", "progressive", lambda v, s, r: {"bump": s * r.uniform(3e6, 6e6), "gap": 0.008}, drivers=("position",)),
        Form("lift", "tyre", lambda v, s, r: {"lift": r.uniform(350.0, 500.0) / s}, drivers=("position",)),
    ),
)
