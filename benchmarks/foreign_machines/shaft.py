"""A motor that turns a fan through a long shaft; the motor's speed is measured, twist and fan are not. A sample each 2 ms."""

from math import tanh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, multisine, read

PERIOD = 2e-3
PLANT = '''"""A motor, a shaft that twists, and a wheel at its other end; a tachometer sits on the motor."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Shaft(Plant):
    r"""Two inertias and a shaft between them.

    .. math:: J_m \\dot\\omega_m = T - c_m \\omega_m - k\\,\\varphi, \\quad \\dot\\varphi = \\omega_m - \\omega_w, \\quad
              J_w \\dot\\omega_w = k\\,\\varphi - c_w \\omega_w
    """

    motor_speed = State("rad/s", typical=20.0)
    twist = State("rad", typical=0.1, start="unknown")
    wheel_speed = State("rad/s", typical=20.0, start="unknown")

    torque = Input("N*m", typical=0.5, text="torque of the motor, from its current")

    motor_inertia = Parameter("kg*m^2", @motor_inertia@, (1e-5, 1.0), "log-uniform", base=True, text="inertia of the motor")
    wheel_inertia = Parameter("kg*m^2", @wheel_inertia@, (1e-5, 1.0), "log-uniform", base=True, text="inertia of the wheel")
    stiffness = Parameter("N*m", @stiffness@, (1e-2, 1e4), "log-uniform", base=True, text="torque for one rad of twist")
    motor_drag = Parameter("N*m*s", @motor_drag@, (1e-5, 1.0), "log-uniform", base=True, text="viscous friction at the motor")
    wheel_drag = Parameter("N*m*s", @wheel_drag@, (1e-5, 1.0), "log-uniform", base=True, text="viscous friction at the wheel")

    period = 2e-3
    tacho_rad_per_s = Measured("tachometer", of="motor_speed")

    @staticmethod
    def equations(state, parameter, drive, rate):
        drive_torque = actuator(drive.torque)
        at_motor = outside("N*m")
        at_wheel = outside("N*m")
        bent = parameter.stiffness * state.twist
        braked = parameter.motor_drag * state.motor_speed
        slowed = parameter.wheel_drag * state.wheel_speed
        rate.motor_speed = body(drive_torque + at_motor - braked - bent, mass=parameter.motor_inertia, load=at_motor)
        rate.twist = state.motor_speed - state.wheel_speed
        rate.wheel_speed = body(bent + at_wheel - slowed, mass=parameter.wheel_inertia, load=at_wheel)
        tachometer = sensor(state.motor_speed)
'''
# Two inertias that swing against each other at some 6 Hz: what is drawn, and what is there where nothing hides.
RIG = {
    "motor_inertia": (0.006, 0.012), "wheel_inertia": (0.015, 0.03), "stiffness": (8.0, 14.0),
    "motor_drag": (0.01, 0.02), "wheel_drag": (0.005, 0.015), "noise": (0.02, 0.08),
    "limit": 1e9, "lag": 0.0, "fan": 0.0, "hard": 0.0, "brake": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels of the torque with a multisine of 0.5 to 15 Hz on them."""
    wanted = np.round(levels(course, count, 150, 700, -0.4, 0.8) + 0.25 * multisine(course, count, PERIOD, 0.5, 15.0), 3)

    def rate(x: list[float], u: float) -> list[float]:
        motor, twist, wheel, late = x
        torque = late if v["lag"] else u
        torque = v["limit"] * tanh(torque / v["limit"]) if v["limit"] < 1e8 else torque
        bent = v["stiffness"] * twist * (1 + v["hard"] * twist * twist)
        slowed = v["wheel_drag"] * wheel + v["fan"] * wheel * abs(wheel) + v["brake"] * tanh(wheel / 0.2)
        return [
            (torque - v["motor_drag"] * motor - bent) / v["motor_inertia"],
            motor - wheel,
            (bent - slowed) / v["wheel_inertia"],
            (u - late) / v["lag"] if v["lag"] else 0.0,
        ]

    states, torque = march(rate, [0.0, 0.0, 0.0, 0.0], PERIOD, count, lambda k, x: float(wanted[k]), 4)
    return {"t_s": np.arange(count) * PERIOD, "T_Nm": torque, "w_rad_s": read(states[:, 0], 0.02, v["noise"], chance)}


MACHINE = Machine(
    "shaft", PLANT, ("motor_inertia", "wheel_inertia", "stiffness", "motor_drag", "wheel_drag"), RIG, measure,
    {"time_s": "t_s", "torque_nm": "T_Nm", "tacho_rad_per_s": "w_rad_s"}, (8000, 3000),
    (
        Form("saturation", "tanh", lambda v, s, r: {"limit": r.uniform(0.9, 1.2) / s}, ("saturation",), False),
        Form("command_delay", "lag", lambda v, s, r: {"lag": s * r.uniform(8e-3, 16e-3)}, ("command_delay",), similar=("sensor_lag",)),
        Form("fan", "square", lambda v, s, r: {"fan": s * r.uniform(4e-4, 8e-4)}, drivers=("velocity",)),
        Form("shaft", "hardening", lambda v, s, r: {"hard": s * r.uniform(150.0, 300.0)}, drivers=("position",)),
        Form("brake", "dry", lambda v, s, r: {"brake": s * r.uniform(0.05, 0.1)}, drivers=("velocity", "direction")),
    ),
)  # fmt: skip
