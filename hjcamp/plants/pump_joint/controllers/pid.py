"""PID on the arm angle with a gain set for each direction of motion."""

from __future__ import annotations

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.parameter import Parameter

LONGEST_DERIVATIVE = 100


class Pid(Controller):
    r"""PID with the derivative taken over n samples; the gains follow the commanded direction.

    .. math:: u_j = s\left(K_p e_j + K_i \sum e_i t_s + K_d \frac{e_j - e_{j-n}}{n t_s}\right)

    While the reference rests, the last commanded direction keeps its gains. With ``bumpless`` 1 the sum is scaled by the
    ratio of the old to the new Ki where the direction changes. Source: thesis 5.2.1.1, 5.2.1.2, 5.2.3.1, Table 5.2.1.
    """

    scale = Parameter("1", 8.5, (1e-3, 1e3), text="pump motor angle for one unit of controller output")
    derivative_samples = Parameter(
        "1", 5.0, (1.0, LONGEST_DERIVATIVE - 1.0), text="samples over which the error is differenced"
    )
    bumpless = Parameter(
        "1", 0.0, (0.0, 1.0), text="1: the integral part of the output stays where it is when gains change; 0: it jumps"
    )
    first_direction = Parameter("1", 1.0, (-1.0, 1.0), text="direction of the first motion")
    positive_kp = Parameter("1", 1.05, (0.0, 1e3), text="proportional gain, positive direction")
    positive_ki = Parameter("1/s", 70.0, (0.0, 1e5), text="integral gain, positive direction")
    positive_kd = Parameter("s", 0.015, (0.0, 10.0), text="derivative gain, positive direction")
    negative_kp = Parameter("1", 1.4, (0.0, 1e3), text="proportional gain, negative direction")
    negative_ki = Parameter("1/s", 90.0, (0.0, 1e5), text="integral gain, negative direction")
    negative_kd = Parameter("s", 0.018, (0.0, 10.0), text="derivative gain, negative direction")

    direction = Memory()
    integral = Memory()
    errors = Memory(size=LONGEST_DERIVATIVE)

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the scaled PID output, and the feedforward as it was computed along the reference."""
        error = sample.reference - sample.arm
        if memory.direction == 0.0:
            memory.direction = parameter.first_direction
            for past in range(100):
                memory.errors[past] = error
        former = parameter.positive_ki if memory.direction > 0.0 else parameter.negative_ki
        if sample.velocity > 0.0:
            memory.direction = 1.0
        elif sample.velocity < 0.0:
            memory.direction = -1.0
        forward = memory.direction > 0.0
        kp = parameter.positive_kp if forward else parameter.negative_kp
        ki = parameter.positive_ki if forward else parameter.negative_ki
        kd = parameter.positive_kd if forward else parameter.negative_kd
        if ki != former:
            memory.integral = memory.integral * (1.0 + parameter.bumpless * (former / max(ki, 1e-9) - 1.0))
        memory.integral = memory.integral + error * sample.period
        count = int(parameter.derivative_samples)
        place = int(sample.index) % 100
        slope = (error - memory.errors[(place + 100 - count) % 100]) / (count * sample.period)
        memory.errors[place] = error
        return parameter.scale * (kp * error + ki * memory.integral + kd * slope), sample.feedforward
