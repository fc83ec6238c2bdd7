"""Two pumps: their difference turns the arm, their sum keeps the mean pressure."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.controllers.pid import Pid
from hjcamp.plants.pump_joint.feedforward import Feedforward

LINE = 2.57e13 * math.pi / 4 * 6.35e-3**2 * 1e-3 / (2 * math.pi)  # Pa for one rad of a pump motor
JOINT_AREA = math.pi / 4 * 4e-3**2


@functools.lru_cache(maxsize=64)
def _feedforward(
    reference: bytes,
    known: tuple[tuple[str, float], ...],
    pressures: tuple[float, float],
    direction: float,
    gain: float,
) -> NDArray[np.float64]:
    rows = np.frombuffer(reference).reshape(-1, 3)
    law = Feedforward(gain, False, "positive")
    return law.command(Simulator(Composition(PumpJoint)), dict(known), rows, pressures, direction)


class SumDifference(Pid):
    r"""FFWD + PID on the difference of two pumps, a scheduled mean pressure on their sum.

    .. math:: \theta_{1,2} = c \pm u, \quad c = \frac{(p_m - p_{m0}) + k_i \sum (p_m - \tfrac{p_1 + p_2}{2}) t_s}{K A_1 l},
              \quad p_m = p_{low} + \frac{F_s}{2 A_2}

    F_s is the static friction of the commanded direction, the larger one while the reference rests; p_m is smoothed over
    20 ms. u is the law of 5.2 and 5.3. Before the test each pump brings its line to its pressure. Thesis 6.4 gives no law.
    """

    samples = ("reference", "velocity", "arm", "pressure1", "pressure2", "feedforward", "period", "index")
    results = ("command1", "command2", "pid", "feedforward")
    planned = ("feedforward",)

    regulate = Parameter("1", 1.0, (0.0, 1.0), text="1 regulates the mean pressure, 0 leaves the sum of the pumps at 0")
    lowest = Parameter("Pa", 0.1e6, (0.0, 1e6), text="pressure that the low line shall keep")
    mean = Parameter("Pa", 0.0, (0.0, 2e6), text="mean pressure at the start; 0 is that of the schedule")
    mean_ki = Parameter("1/s", 15.0, (0.0, 100.0), text="integral gain on the mean pressure (assumed)")
    smoothing = Parameter("s", 0.02, (1e-4, 1.0), text="time constant of the schedule (assumed)")
    static_positive = Parameter("N", 7.20, (0.0, 60.0), text="static friction of its model, positive direction")
    static_negative = Parameter("N", 4.03, (0.0, 60.0), text="static friction of its model, negative direction")
    ahead_positive = Parameter("Pa", 0.2e6, (0.0, 1e6), text="p1 - p2 at the start of a positive motion (5.2.4.1)")
    ahead_negative = Parameter("Pa", 0.1e6, (0.0, 1e6), text="p2 - p1 at the start of a negative motion")
    feedforward_gain = Parameter("1", 1.23, (0.0, 100.0), text="gain of the feedforward (5.3.3)")

    joint_area = Parameter("m^2", JOINT_AREA, (1e-9, 1e-2), text="bore area of a joint cylinder in its model")
    line_pressure = Parameter("Pa/rad", LINE, (1.0, 1e9), text="pressure of a line for one rad of its pump in its model")

    begun = Memory()
    wanted = Memory()
    start = Memory()
    lacking = Memory()

    @classmethod
    def begin(cls, parameter: Mapping[str, float], plant: Mapping[str, float]) -> dict[str, float]:
        """Return the pressures to which the pumps bring their lines before the test, Pa."""
        forward = parameter["first_direction"] > 0.0
        static = parameter["static_positive" if forward else "static_negative"]
        mean = parameter["mean"] or parameter["lowest"] + static / (2 * parameter["joint_area"])
        ahead = parameter["ahead_positive"] if forward else -parameter["ahead_negative"]
        return {"pressure1": mean + 0.5 * ahead, "pressure2": mean - 0.5 * ahead}

    @classmethod
    def plan(
        cls, reference: NDArray[np.float64], parameter: Mapping[str, float], plant: Mapping[str, float], period: float
    ) -> NDArray[np.float64]:
        """Return the feedforward (n, 1) of 5.3.3, rad: the pump joint's, which is half the difference of two pumps."""
        known = tuple((name, plant[name]) for name in PumpJoint.parameters if name in plant)
        start = cls.begin(parameter, plant)
        pressures = (start["pressure1"], start["pressure2"])
        direction, gain = parameter["first_direction"], parameter["feedforward_gain"]
        return _feedforward(reference.tobytes(), known, pressures, direction, gain)[:, None]

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the commands of both pumps, and the feedback and feedforward parts of their difference."""
        pid, ahead = part(Pid.step, sample, parameter, memory)
        half = 0.5 * (sample.pressure1 + sample.pressure2)
        static = max(parameter.static_positive, parameter.static_negative)
        if sample.velocity > 0.0:
            static = parameter.static_positive
        elif sample.velocity < 0.0:
            static = parameter.static_negative
        goal = parameter.lowest + static / (2.0 * parameter.joint_area)
        if memory.begun == 0.0:
            memory.begun = 1.0
            memory.start = half
            memory.wanted = half
        memory.wanted = memory.wanted + (goal - memory.wanted) * min(sample.period / parameter.smoothing, 1.0)
        memory.lacking = memory.lacking + (memory.wanted - half) * sample.period
        both = (
            parameter.regulate * (memory.wanted - memory.start + parameter.mean_ki * memory.lacking) / parameter.line_pressure
        )
        turn = pid + ahead
        return both + turn, both - turn, pid, ahead
