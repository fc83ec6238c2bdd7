"""A motor, a belt, a carriage: an encoder at each end."""

from math import exp, pi, sin, tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, march, multisine, read

PERIOD, RADIUS = 0.005, 0.02
PLANT = '''"""A motor drives a carriage over a belt; an encoder on the motor, a scale at the carriage."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, transmission


class Belt(Plant):
    r"""A stiff belt: all that moves is one inertia.

    .. math:: J \\dot \\omega = k_m u - b \\omega - M_c\\,\\mathrm{sign}\\,\\omega, \\quad x = r \\varphi
    """

    angle = State("rad", typical=3.0)
    speed = State("rad/s", typical=10.0)

    voltage = Input("V", typical=3.0, text="voltage of the amplifier")

    gain = Parameter("N*m/V", 0.05, text="torque for one volt, from the data sheet")
    inertia = Parameter("kg*m^2", @inertia@, (1e-6, 1.0), "log-uniform", base=True, text="motor, pulleys and carriage")
    viscous = Parameter("N*m*s", @viscous@, (1e-6, 1.0), "log-uniform", base=True, text="viscous friction, and the motor's own")
    coulomb = Parameter("N*m", @coulomb@, (1e-5, 1.0), "log-uniform", base=True, text="Coulomb friction")
    radius = Parameter("m/rad", 0.02, text="radius of the pulley")

    period = 0.005
    motor_rad = Measured("encoder", of="angle")
    carriage_mm = Measured("scale")

    @staticmethod
    def equations(state, parameter, drive, rate):
        torque = actuator(parameter.gain * drive.voltage)
        load = outside("N*m")
        friction = contact(
            state.speed, push=torque + load, coulomb=parameter.coulomb, viscous=parameter.viscous, travel=state.angle
        )
        rate.angle = state.speed
        rate.speed = body(torque + load - friction, mass=parameter.inertia, load=load, position=state.angle)
        carriage = transmission(parameter.radius * state.angle)
        encoder = sensor(state.angle)
        scale = sensor(carriage)
'''
# A drive with a mechanical time constant of some 0.3 s: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "inertia": (1.2e-3, 2e-3), "viscous": (4e-3, 7e-3), "coulomb": (0.01, 0.02),
    "noise": (1e-5, 3e-5), "belt": 1e6, "play": 0.0, "sticks": 0.0, "drag": 0.0, "ripple": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: a multisine voltage with a weak loop that keeps the carriage in its range."""
    volts = 1.6 * multisine(course, count, PERIOD, 0.3, 6.0)
    own, other = 0.35 * v["inertia"], 0.65 * v["inertia"] / RADIUS**2

    def drive(k: int, x: list[float]) -> float:
        return round(float(volts[k]) - 0.25 * x[0], 3)

    def rate(x: list[float], u: float) -> list[float]:
        angle, speed, place, pace = x
        stretch = RADIUS * angle - place
        if v["play"]:
            stretch -= max(-0.5 * v["play"], min(0.5 * v["play"], stretch))
        pull = v["belt"] * stretch + 200.0 * (RADIUS * speed - pace) * (1.0 if stretch or not v["play"] else 0.0)
        friction = v["coulomb"] * (1 + v["sticks"] * exp(-abs(speed) / 1.5)) * tanh(speed / 0.05)
        torque = 0.05 * u + v["ripple"] * sin(6 * angle)
        motor = torque - v["viscous"] * speed - 0.7 * friction - v["drag"] * speed * abs(speed) - RADIUS * pull
        load = pull - 0.3 * v["coulomb"] / RADIUS * tanh(pace / 1e-3)
        return [speed, motor / own, pace, load / other]

    states, voltage = march(rate, [0.0] * 4, PERIOD, count, drive, 20)
    step = 2 * pi / 4096
    return {
        "t_s": np.arange(count) * PERIOD,
        "u_V": voltage,
        "phi_rad": read(states[:, 0], step, 0.0, chance),
        "x_mm": 1e3 * read(states[:, 2], 1e-5, v["noise"], chance),
    }


MACHINE = Machine(
    "belt", PLANT, ("inertia", "viscous", "coulomb"), RIG, measure,
    {"time_s": "t_s", "voltage_v": "u_V", "motor_rad": "phi_rad", "carriage_mm": "x_mm"}, (6000, 2000),
    (
        Form("backlash", "free_play", lambda v, s, r: {"play": s * r.uniform(0.6e-3, 1.2e-3)}, ("backlash",), False),
        Form("stribeck", "exponential", lambda v, s, r: {"sticks": s * r.uniform(1.0, 1.6)}, ("stribeck_excess",), False),
        Form("belt", "soft", lambda v, s, r: {"belt": r.uniform(3e3, 6e3) / s}, drivers=("acceleration", "force")),
        Form("ripple", "cogging", lambda v, s, r: {"ripple": s * r.uniform(0.015, 0.025)}, drivers=("position",)),
    ),
)  # fmt: skip
