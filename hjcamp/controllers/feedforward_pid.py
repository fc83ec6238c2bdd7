"""PID with the input that a model needs for the reference: any plant whose model can be inverted."""

from __future__ import annotations

from hjcamp.controllers.plain_pid import PlainPid
from hjcamp.model.declare.parameter import Parameter


class FeedforwardPid(PlainPid):
    r"""PID on the controlled channel around the input with which a model follows the reference.

    .. math:: u_j = u_0 + g\,u_d(t_j) + K_p e_j + K_i \sum e_i t_s + K_d \frac{e_j - e_{j-n}}{n t_s}, \quad |u_j| \le u_{max}

    u_d inverts ``controller.model``, as declared or identified: its one or two states follow from the reference and its
    derivatives, the input from the equations and effects (`hjcamp.model.run.inverse`). A model that cannot be inverted is refused with
    the reason. The other parameters are those of ``plain_pid``.
    """

    samples = ("reference", "measured", "feedforward", "period", "index")
    planned = ("feedforward",)
    inverts = True

    gain = Parameter("1", 1.0, (0.0, 100.0), text="factor on the feedforward")

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
        ahead = parameter.offset + parameter.gain * sample.feedforward
        wanted = ahead + parameter.kp * error + parameter.ki * grown + parameter.kd * slope
        output = min(max(wanted, -parameter.limit), parameter.limit)
        if output == wanted or (wanted - output) * parameter.ki * error < 0.0:
            memory.integral = grown
        return output
