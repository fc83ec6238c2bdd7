"""Two pumps: the one behind the motion turns the arm, the other keeps its line at a low pressure; the roles change."""

from __future__ import annotations

from collections.abc import Mapping

from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint.controllers.pid import Pid
from hjcamp.plants.two_pumps.controllers.sum_difference import SumDifference


class PushHold(SumDifference):
    r"""FFWD + PID on the pushing pump; the other follows the arm and holds its line at p_low by a PI law.

    .. math:: \theta_{hold} = \mp 8.5\,\theta_a + \frac{k_p (p_{low} - p) + k_i \sum (p_{low} - p) t_s}{K A_1 l}

    Where the direction changes the pumps change their roles, each from the command that it has. Thesis 6.4 gives no law.
    """

    hold_kp = Parameter("1", 0.2, (0.0, 10.0), text="proportional gain on the pressure of the held line (assumed)")

    last1 = Memory()
    last2 = Memory()
    offset = Memory()
    pushing = Memory()

    @classmethod
    def begin(cls, parameter: Mapping[str, float], plant: Mapping[str, float]) -> dict[str, float]:
        """Return the pressures before the test: the held line at the lowest, the other ahead of it, Pa."""
        low = parameter["lowest"]
        if parameter["first_direction"] > 0.0:
            return {"pressure1": low + parameter["ahead_positive"], "pressure2": low}
        return {"pressure1": low, "pressure2": low + parameter["ahead_negative"]}

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the commands of both pumps, and the feedback and feedforward parts of the pushing one."""
        pid, ahead = part(Pid.step, sample, parameter, memory)
        forward = memory.direction > 0.0
        if memory.pushing == 0.0:
            memory.pushing = parameter.first_direction
        turn = memory.direction * (pid + ahead)
        low = sample.pressure2 if forward else sample.pressure1
        away = -memory.direction * parameter.scale * sample.arm
        lack = parameter.lowest - low
        if memory.pushing != memory.direction:
            memory.pushing = memory.direction
            memory.offset = (memory.last1 if forward else memory.last2) - turn
            held = memory.last2 if forward else memory.last1
            memory.lacking = ((held - away) * parameter.line_pressure - parameter.hold_kp * lack) / max(parameter.mean_ki, 1e-9)
        memory.lacking = memory.lacking + lack * sample.period
        push = turn + memory.offset
        hold = away + (parameter.hold_kp * lack + parameter.mean_ki * memory.lacking) / parameter.line_pressure
        memory.last1 = push if forward else hold
        memory.last2 = hold if forward else push
        return memory.last1, memory.last2, pid, ahead
