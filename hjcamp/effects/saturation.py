"""A command that has a largest value."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class Saturation(Effect):
    r"""An actuator delivers no more than its limit, whatever is commanded.

    .. math:: u \leftarrow \min(\max(u, -u_m),\ u_m)

    Seen as: large commands that lack the more, the larger they are; small ones are followed exactly.
    Not for: a limit that the logged command already has in it.
    Source: Khalil (2002), Nonlinear Systems, 3rd ed., section 1.2.7.
    """

    acts_on = "actuator"
    limit = Parameter(
        "command", 1.0, (0.05, 20.0), "log-uniform", "largest size of what is delivered", shape=True, off=20.0
    )

    @staticmethod
    def command(command, limit):
        """Command within the limit."""
        return max(-limit, min(limit, command))
