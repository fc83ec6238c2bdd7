"""A command that has a largest value."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Saturation(Effect):
    r"""An actuator delivers no more than its limit, whatever is commanded.

    .. math:: u \leftarrow \frac{u}{(1 + |u / u_m|^{1/s})^s}, \quad s \to 0: \ \min(\max(u, -u_m),\ u_m)

    Seen as: large commands that lack the more, the larger they are; small ones are followed exactly, or nearly so where it is soft.
    Not for: a limit that the logged command already has in it.
    Source: Khalil (2002), Nonlinear Systems, 3rd ed., section 1.2.7; soft limits: Rapp (1991), Effects of HPA-nonlinearity on a
    4-DPSK/OFDM-signal for a digital sound broadcasting system, eq. 1.
    """

    acts_on = "actuator"
    limit = Parameter("command", 1.0, (0.05, 20.0), "log-uniform", "largest size of what is delivered", shape=True, off=20.0)
    softness = Parameter(
        "1", 0.0, (0.0, 1.0), text="0: a sharp limit; 1: what is delivered bends from the first volt on", shape=True
    )

    @staticmethod
    def command(command, limit, softness):
        """Command within the limit."""
        return (
            command / (1.0 + abs(command / limit) ** (1.0 / softness)) ** softness
            if softness > 0.025  # sharper than this is a sharp limit
            else max(-limit, min(limit, command))
        )
