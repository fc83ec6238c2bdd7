"""Open loop: the scaled reference is the command."""

from __future__ import annotations

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.parameter import Parameter


class OpenLoop(Controller):
    r"""The pump follows the scaled reference, whatever the arm does.

    .. math:: \theta_{md} = s\,\theta_{ad}

    Source: thesis 4.6.1 (scale 8.5) and 4.6.2.
    """

    uses_arm = False

    scale = Parameter("1", 8.5, (1e-3, 1e3), text="pump motor angle for one unit of arm angle")

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return no feedback and the scaled reference."""
        return 0.0, parameter.scale * sample.reference
