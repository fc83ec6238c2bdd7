"""A trolley with a load on a rope, driven by a motor; trolley and rope angle are measured."""

from math import cos, pi, sin, tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, multisine, read

PERIOD, GRAVITY, TROLLEY = 0.01, 9.81, 4.0
PLANT = '''"""A trolley on a rail with a load that hangs from it."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, cos, outside, sensor, sin


class Crane(Plant):
    r"""Trolley and pendulum.

    .. math:: (M + m \\sin^2\\theta)\\,\\ddot x = F - R + m \\sin\\theta\\,(l \\dot\\theta^2 + g \\cos\\theta), \\quad
        l \\ddot\\theta = -\\ddot x \\cos\\theta - g \\sin\\theta - d\\,l\\,\\dot\\theta
    """

    position = State("m", typical=0.3)
    velocity = State("m/s", typical=0.3)
    swing = State("rad", typical=0.2)
    swing_speed = State("rad/s", typical=0.8)

    voltage = Input("V", typical=3.0, text="voltage of the trolley's drive")

    gain = Parameter("N/V", @gain@, (0.1, 100.0), "log-uniform", base=True, text="force for one volt")
    trolley = Parameter("kg", 4.0, text="trolley, weighed")
    load_mass = Parameter("kg", 1.5, text="load, weighed")
    coulomb = Parameter("N", @coulomb@, (0.01, 100.0), "log-uniform", base=True, text="Coulomb friction of the trolley")
    viscous = Parameter("N*s/m", @viscous@, (0.01, 1e3), "log-uniform", base=True, text="viscous friction of the trolley")
    rope = Parameter("m", @rope@, (0.1, 5.0), "log-uniform", base=True, text="length of the rope")
    decay = Parameter("1/s", @decay@, (1e-4, 10.0), "log-uniform", base=True, text="damping of the swing")
    gravity = Parameter("m/s^2", 9.81, text="gravity")

    period = 0.01
    position_mm = Measured("scale", of="position")
    swing_deg = Measured("encoder", of="swing")

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(parameter.gain * drive.voltage)
        load = outside("N")
        rope_pull = parameter.load_mass * sin(state.swing) * (
            parameter.rope * state.swing_speed ** 2 + parameter.gravity * cos(state.swing)
        )
        moved = parameter.trolley + parameter.load_mass * sin(state.swing) ** 2
        friction = contact(
            state.velocity, push=force + rope_pull + load, coulomb=parameter.coulomb, viscous=parameter.viscous,
            travel=state.position, mass=moved,
        )
        rate.position = state.velocity
        rate.velocity = body(force + rope_pull + load - friction, mass=moved, load=load, position=state.position)
        rate.swing = state.swing_speed
        rate.swing_speed = (
            -(rate.velocity * cos(state.swing) + parameter.gravity * sin(state.swing)) / parameter.rope
            - parameter.decay * state.swing_speed
        )
        scale = sensor(state.position)
        encoder = sensor(state.swing)
'''
# A model crane: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "gain": (4.0, 6.0), "coulomb": (1.5, 3.0), "viscous": (8.0, 14.0),
    "rope": (0.5, 0.8), "decay": (0.05, 0.1), "noise": (3e-5, 1e-4),
    "bearing": 0.0, "steep": 0.0, "drag": 0.0, "winch": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels of the voltage and a multisine, with a weak loop that keeps the trolley on its rail."""
    volts = 2.0 * multisine(course, count, PERIOD, 0.1, 1.5) + levels(course, count, 60, 250, -2.0, 2.0)

    def rate(x: list[float], u: float) -> list[float]:
        place, speed, angle, turn, time = x
        rope = v["rope"] * (1 + v["winch"] * sin(2 * pi * time / 25))
        friction = v["coulomb"] * tanh(speed / 0.003) + v["viscous"] * speed
        friction *= 1 + v["steep"] * (1 / (1 + ((place - 0.1) / 0.08) ** 2))  # a rough place on the rail
        force = v["gain"] * u - friction + 1.5 * sin(angle) * (rope * turn**2 + GRAVITY * cos(angle))
        pace = force / (TROLLEY + 1.5 * sin(angle) ** 2)
        air = v["drag"] * turn * abs(turn) + v["bearing"] * tanh(turn / 0.02)
        return [speed, pace, turn, -(pace * cos(angle) + GRAVITY * sin(angle)) / rope - v["decay"] * turn - air, 1.0]

    states, voltage = march(rate, [0.0] * 5, PERIOD, count, lambda k, x: round(float(volts[k]) - 6.0 * x[0], 3), 10)
    return {
        "t_s": np.arange(count) * PERIOD,
        "u_V": voltage,
        "x_mm": 1e3 * read(states[:, 0], 5e-5, v["noise"], chance),
        "rope_deg": np.degrees(read(states[:, 2], 2 * pi / 8192, 0.0, chance)),
    }


MACHINE = Machine(
    "crane", PLANT, ("gain", "coulomb", "viscous", "rope", "decay"), RIG, measure,
    {"time_s": "t_s", "voltage_v": "u_V", "position_mm": "x_mm", "swing_deg": "rope_deg"}, (6000, 2000),
    (
        Form("position_friction", "bump", lambda v, s, r: {"steep": s * r.uniform(0.6, 1.0)}, ("position_friction",), False),
        Form("bearing", "coulomb", lambda v, s, r: {"bearing": s * r.uniform(0.3, 0.5)}, drivers=("velocity",)),
        Form("drag", "of_the_load", lambda v, s, r: {"drag": s * r.uniform(0.15, 0.3)}, drivers=("velocity",)),
        Form("winch", "sine", lambda v, s, r: {"winch": s * r.uniform(0.04, 0.07)}, drivers=("time",)),
    ),
)  # fmt: skip
