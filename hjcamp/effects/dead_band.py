"""A command that must pass a threshold."""

from __future__ import annotations

from math import copysign

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class DeadBand(Effect):
    r"""What is commanded does nothing until it has passed a dead band, and lacks the band beyond it.

    .. math:: u \leftarrow \mathrm{sign}(u)\,\max(|u| - b,\ 0)

    Seen as: small commands without any answer, and large ones that lack the same amount in both directions.
    Not for: friction, which holds against all that pushes (see stribeck_excess), or play (see backlash).
    Source: Tao & Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor Nonlinearities, chapter 2.
    """

    acts_on = "actuator"
    width = Parameter("command", 0.05, (0.0, 1.7), text="half of the band: the command that does nothing yet", off=0.0)

    @staticmethod
    def command(command, width):
        """Command beyond the band."""
        return copysign(max(abs(command) - width, 0.0), command)
