"""A steel ball under a magnet, held by somebody else's loop; the current is what drives it."""

import numpy as np
from truth.hidden_form import Form

from .machine import Columns, Machine, Values, levels, march, multisine, read

PERIOD, GRAVITY = 0.002, 9.81
PLANT = '''"""A steel ball that hangs under a magnet; another loop sets the current of the magnet."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Levitation(Plant):
    r"""Force of a magnet over an air gap.

    .. math:: m \\ddot z = m g - K \\frac{i^2}{z^2}
    """

    gap = State("m", typical=0.01, low=0.001)
    velocity = State("m/s", typical=0.02)

    current = Input("A", typical=1.0, text="current of the magnet")

    mass = Parameter("kg", 0.068, text="mass of the ball, weighed")
    gravity = Parameter("m/s^2", 9.81, text="gravity")
    magnet = Parameter("N*m**2/A**2", @magnet@, (1e-6, 1e-3), "log-uniform", base=True, text="constant of the magnet")

    period = 0.002
    gap_mm = Measured("photocell", of="gap")
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, drive, rate):
        i = actuator(drive.current)
        pull = parameter.magnet * i * i / (state.gap * state.gap)
        load = outside("N")
        rate.gap = state.velocity
        rate.velocity = body(parameter.mass * parameter.gravity + load - pull, mass=parameter.mass, load=load, position=state.gap)
        photocell = sensor(state.gap)
'''
# A magnet that needs about 0.8 A at 10 mm: what is drawn between two ends, and what is there where nothing hides.
RIG = {
    "magnet": (0.8e-4, 1.3e-4), "mass": 0.068, "noise": (3e-6, 8e-6), "lag": 0.0,
    "zero": 0.0, "eddy": 0.0, "reach": 0.0,
}  # fmt: skip


def measure(v: Values, course: np.random.Generator, chance: np.random.Generator, count: int) -> Columns:
    """Return a log: levels and a multisine of the wanted gap, 7 to 13 mm, PD and a slow integral on what the photocell reads."""
    wanted = 0.01 + 5e-4 * multisine(course, count, PERIOD, 0.2, 4.0) + levels(course, count, 400, 1200, -1.5e-3, 1.5e-3)
    read_gap = np.empty(count)
    memory = {"before": 0.01, "sum": 0.0}

    def drive(k: int, x: list[float]) -> float:
        reading = float(read(np.array([x[0] + v["zero"]]), 2e-6, v["noise"], chance)[0])
        read_gap[k] = reading
        error, speed = reading - wanted[k], (reading - memory["before"]) / PERIOD
        memory["before"] = reading
        memory["sum"] += error * PERIOD
        return round(float(np.clip(0.8 + 240.0 * error + 5.0 * speed + 150.0 * memory["sum"], 0.0, 3.0)), 4)

    def rate(x: list[float], u: float) -> list[float]:
        current = x[2] if v["lag"] else u
        drag = v["eddy"] * x[1] * (0.01 / max(x[0], 1e-3)) ** 3
        force = v["mass"] * GRAVITY - v["magnet"] * (current / (max(x[0], 1e-3) + v["reach"])) ** 2 - drag
        return [x[1], force / v["mass"], (u - x[2]) / v["lag"] if v["lag"] else 0.0]

    _, current = march(rate, [0.01, 0.0, 0.8], PERIOD, count, drive, 3)
    return {"t_s": np.arange(count) * PERIOD, "z_mm": 1e3 * read_gap, "i_A": current}


MACHINE = Machine(
    "levitation", PLANT, ("magnet",), RIG, measure,
    {"time_s": "t_s", "gap_mm": "z_mm", "current_a": "i_A"}, (8000, 3000),
    (
        Form("sensor_offset", "zero", lambda v, s, r: {"zero": s * r.uniform(0.8e-3, 1.5e-3)}, ("sensor_offset",), True),
        Form("command_delay", "lag", lambda v, s, r: {"lag": s * r.uniform(2e-3, 4e-3)}, ("command_delay",), False,
             similar=("sensor_lag",)),
        Form("eddy", "braking", lambda v, s, r: {"eddy": s * r.uniform(0.4, 0.8)}, drivers=("velocity", "position")),
        Form("reach", "stray_field", lambda v, s, r: {"reach": s * r.uniform(2e-3, 4e-3), "magnet": 1.6 * v["magnet"]},
             drivers=("position",), similar=("sensor_offset",)),
    ),
)  # fmt: skip
