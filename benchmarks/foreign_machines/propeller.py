"""A beam that a propeller tilts; its bearing turns in a box of oil or in air."""

from __future__ import annotations

from math import exp, pi, sin, tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, multisine, read

PERIOD = 0.01
PLANT = '''"""The pitch of a beam with a propeller at its end; a potentiometer reads the angle."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, sin


class Propeller(Plant):
    r"""Thrust with a lag, weight, friction.

    .. math:: J \\ddot\\theta = M - G \\sin\\theta - b \\dot\\theta - M_c\\,\\mathrm{sign}\\,\\dot\\theta,
        \\quad \\tau \\dot M = k u - M
    """

    pitch = State("rad", typical=0.4)
    pitch_speed = State("rad/s", typical=1.0)
    thrust = State("N*m", typical=0.3, start="unknown")

    command = Input("1", typical=0.5, text="duty of the motor controller; the logs hold it as command_ratio")

    weight = Parameter("N*m", 0.6, text="weight times lever, from a spring balance")
    inertia = Parameter("kg*m^2", @inertia@, (1e-4, 10.0), "log-uniform", base=True, text="beam and motor")
    gain = Parameter("N*m", @gain@, (0.01, 10.0), "log-uniform", base=True, text="torque of the thrust at full duty")
    lag = Parameter("s", @lag@, (0.01, 2.0), "log-uniform", base=True, text="time constant of the propeller")
    viscous = Parameter("N*m*s", @viscous@, (1e-4, 1.0), "log-uniform", base=True, text="viscous friction")
    coulomb = Parameter("N*m", @coulomb@, (1e-5, 1.0), "log-uniform", base=True, text="Coulomb friction of the bearing")

    period = 0.01
    pitch_deg = Measured("potentiometer", of="pitch")

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Newton about the bearing."""
        wanted = actuator(parameter.gain * drive.command)
        rate.thrust = (wanted - state.thrust) / parameter.lag
        load = outside("N*m")
        push = state.thrust - parameter.weight * sin(state.pitch) + load
        friction = contact(
            state.pitch_speed, push=push, coulomb=parameter.coulomb, viscous=parameter.viscous, travel=state.pitch
        )
        rate.pitch = state.pitch_speed
        rate.pitch_speed = body(push - friction, mass=parameter.inertia, load=load, position=state.pitch)
        potentiometer = sensor(state.pitch)
'''


def draw(random: np.random.Generator) -> Values:
    """Return a beam that swings at about 0.7 Hz."""
    return {
        "inertia": random.uniform(0.02, 0.035), "gain": random.uniform(0.5, 0.7), "lag": random.uniform(0.08, 0.16),
        "viscous": random.uniform(0.01, 0.02), "coulomb": random.uniform(4e-3, 8e-3), "noise": random.uniform(1e-3, 2e-3),
        "drag": 0.0, "tilt": 0.0, "ground": 0.0, "square": 0.0,
    }  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels and a multisine of the duty, both ways."""
    duty = 0.12 * multisine(course, count, PERIOD, 0.1, 2.0) + levels(course, count, 100, 400, -0.25, 0.25)
    duty = np.round(np.clip(duty, -1.0, 1.0), 3)

    def rate(x: list[float], u: float) -> list[float]:
        pitch, speed, thrust = x
        friction = v["coulomb"] * tanh(speed / 0.01) + v["viscous"] * speed
        friction += v["drag"] * speed * abs(speed) ** 0.7
        near = 1 + v["ground"] * min(exp((-0.3 - pitch) / 0.15), 3.0)  # the lower, the more thrust
        wanted = v["gain"] * ((1 - v["square"]) * u + v["square"] * 2.0 * u * abs(u))
        torque = thrust * near - 0.6 * sin(pitch - v["tilt"]) - friction
        return [speed, torque / v["inertia"], (wanted - thrust) / v["lag"]]

    states, duty = march(rate, [0.0] * 3, PERIOD, count, lambda k, x: float(duty[k]), 6)
    angle = read(states[:, 0], 2 * pi / 4096, v["noise"], chance)
    return {"t_s": np.arange(count) * PERIOD, "duty_pc": 100 * duty, "pitch_deg": np.degrees(angle)}


MACHINE = Machine(
    "propeller", PLANT, ("inertia", "gain", "lag", "viscous", "coulomb"), draw, measure,
    {"time_s": "t_s", "command_ratio": {"column": "duty_pc", "unit": "%"}, "pitch_deg": "pitch_deg"}, (8000, 3000),
    (
        Form("quadratic_drag", "power_1.7", lambda v, s, r: {"drag": s * r.uniform(0.02, 0.03)}, ("quadratic_drag",), False),
        Form("constant_force", "tilted", lambda v, s, r: {"tilt": s * r.uniform(0.1, 0.2)}, ("constant_force",), False,
             alike=("sensor_offset",)),
        Form("ground", "exponential", lambda v, s, r: {"ground": s * r.uniform(0.15, 0.3)}, drivers=("position",)),
        Form("thrust", "square", lambda v, s, r: {"square": s * r.uniform(0.4, 0.7)}, drivers=("demand",)),
    ),
)  # fmt: skip
