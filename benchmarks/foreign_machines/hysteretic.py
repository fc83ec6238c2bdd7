"""A mass on a mount, driven by a shaker; the mount has a memory (Bouc-Wen) where that hides."""

from math import sinh

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, march, multisine, read

PERIOD = 1 / 750
PLANT = '''"""A mass on a mount, pushed by a shaker; a laser sees where it is."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Hysteretic(Plant):
    r"""An oscillator of one mass.

    .. math:: m \\ddot x + c \\dot x + k x = F
    """

    position = State("m", typical=1e-3)
    velocity = State("m/s", typical=0.1)

    force = Input("N", typical=50.0, text="force of the shaker, measured by its cell")

    mass = Parameter("kg", @mass@, (0.1, 100.0), "log-uniform", base=True, text="moving mass")
    damping = Parameter("N*s/m", @damping@, (0.1, 1e3), "log-uniform", base=True, text="damping of the mount")
    stiffness = Parameter("N/m", @stiffness@, (1e3, 1e6), "log-uniform", base=True, text="stiffness of the mount")

    period = 1 / 750
    position_mm = Measured("laser", of="position")

    @staticmethod
    def equations(state, parameter, drive, rate):
        push = actuator(drive.force)
        load = outside("N")
        mount = parameter.damping * state.velocity + parameter.stiffness * state.position
        rate.position = state.velocity
        rate.velocity = body(push + load - mount, mass=parameter.mass, load=load, position=state.position)
        laser = sensor(state.position)
'''
# A mount with a resonance at about 30 Hz: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "mass": (1.6, 2.4), "damping": (15.0, 30.0), "stiffness": (5e4, 9e4),
    "noise": (5e-7, 2e-6), "hard": 0.0, "bristle": 0.0, "beta": 1.0, "memory": 0.0, "lag": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: a multisine of 5 to 90 Hz."""
    force = np.round(50.0 * multisine(course, count, PERIOD, 5.0, 90.0), 2)

    def rate(x: list[float], u: float) -> list[float]:
        place, speed, z, late = x
        spring = v["stiffness"] * place
        if v["hard"]:
            spring = v["stiffness"] * sinh(v["hard"] * place) / v["hard"]
        spring += v["memory"] * z
        bent = speed - v["beta"] * (0.6 * abs(speed) * z + 0.4 * speed * abs(z)) if v["memory"] else 0.0
        push = late if v["lag"] else u
        return [speed, (push - v["damping"] * speed - spring) / v["mass"], bent, (u - late) / v["lag"] if v["lag"] else 0.0]

    states, push = march(rate, [0.0, 0.0, 0.0, 0.0], PERIOD, count, lambda k, x: float(force[k]), 4)
    return {"t_s": np.arange(count) * PERIOD, "F_N": push, "x_mm": 1e3 * read(states[:, 0], 1e-6, v["noise"], chance)}


MACHINE = Machine(
    "hysteretic", PLANT, ("mass", "damping", "stiffness"), RIG, measure,
    {"time_s": "t_s", "force_n": "F_N", "position_mm": "x_mm"}, (8000, 3000),
    (
        Form("cubic_spring", "sinh", lambda v, s, r: {"hard": s * r.uniform(600.0, 900.0)}, ("cubic_spring",), False),
        Form("command_delay", "lag", lambda v, s, r: {"lag": s * r.uniform(1.5e-3, 3e-3)}, ("command_delay",), False,
             similar=("sensor_lag",)),
        Form("memory", "bouc_wen", lambda v, s, r: {"memory": s * r.uniform(2e4, 4e4), "beta": r.uniform(800.0, 1500.0)},
             drivers=("position", "velocity")),
    ),
)  # fmt: skip
