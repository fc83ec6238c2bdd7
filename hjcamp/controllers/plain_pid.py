"""PID on what a plant controls: any plant, one commanded input."""

from __future__ import annotations

from typing import ClassVar

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.parameter import Parameter

LONGEST_DERIVATIVE = 100


class PlainPid(Controller):
    r"""PID on the controlled channel, with the derivative taken over n samples and a command within a limit.

    .. math:: u_j = u_0 + K_p e_j + K_i \sum e_i t_s + K_d \frac{e_j - e_{j-n}}{n t_s}, \quad |u_j| \le u_{max}

    Gains are in SI: the unit of the input for one unit of the channel (V/m where a voltage moves a carriage). The integral
    waits while the command is at its limit and the error would push it further. ``controller.input`` says which input;
    the plant's only one unless said.
    """

    samples: ClassVar[tuple[str, ...]] = ("reference", "measured", "period", "index")
    results = ("output",)
    tuned: ClassVar[tuple[str, ...]] = ("kp", "ki", "kd")

    kp = Parameter("1", 1.0, (-1e12, 1e12), text="proportional gain: input for one unit of the channel")
    ki = Parameter("1/s", 0.0, (-1e12, 1e12), text="integral gain")
    kd = Parameter("s", 0.0, (-1e12, 1e12), text="derivative gain")
    derivative_samples = Parameter(
        "1", 5.0, (1.0, LONGEST_DERIVATIVE - 1.0), text="samples over which the error is differenced"
    )
    offset = Parameter("1", 0.0, (-1e12, 1e12), text="input where the error is 0 and always was")
    limit = Parameter("1", 1e12, (1e-12, 1e12), text="largest input, without sign")

    begun = Memory()
    integral = Memory()
    errors = Memory(size=LONGEST_DERIVATIVE)

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the command."""
        error = sample.reference - sample.measured
        if memory.begun == 0.0:
            memory.begun = 1.0
            for past in range(100):
                memory.errors[past] = error
        count = int(parameter.derivative_samples)
        place = int(sample.index) % 100
        slope = (error - memory.errors[(place + 100 - count) % 100]) / (count * sample.period)
        memory.errors[place] = error
        grown = memory.integral + error * sample.period
        wanted = parameter.offset + parameter.kp * error + parameter.ki * grown + parameter.kd * slope
        output = min(max(wanted, -parameter.limit), parameter.limit)
        if output == wanted or (wanted - output) * parameter.ki * error < 0.0:
            memory.integral = grown
        return output
