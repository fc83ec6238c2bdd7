"""An end of the travel from which a body bounces."""

from __future__ import annotations

from math import copysign

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class HardStop(Effect):
    r"""At one end of its travel a body meets a stiff stop that gives back part of the energy.

    .. math:: F \mathrel{+}= -s\,\max\bigl(k\,d\,(1 + \lambda\,\dot d),\ 0\bigr), \quad d = \max\bigl(s\,(x - x_e),\ 0\bigr), \quad
              s = \mathrm{sign}\,x_e

    with d how far it is pressed in: the upper end where x_e is positive, the lower one where it is negative. Hunt and
    Crossley's law: no leap of the force at first touch, and no pull.
    Seen as: motion that turns round or ends at one position, with less speed after than before.
    Not for: both ends the same without loss (see soft_stop).
    Source: Hunt & Crossley (1975), Journal of Applied Mechanics 42(2), 440-445, doi:10.1115/1.3423596.
    """

    acts_on = "body"
    end = Parameter("position", 0.8, (-10.0, 10.0), text="position of the stop", shape=True)
    stiffness = Parameter("force/position", 50.0, (0.0, 1e5), text="force for each unit of travel beyond it", off=0.0)
    loss = Parameter("1/velocity", 0.5, (0.0, 10.0), text="share of force added by each unit of speed inwards")

    @staticmethod
    def force(position, velocity, end, stiffness, loss):
        """Force of the stop."""
        side = copysign(1.0, end)
        depth = max(side * (position - end), 0.0)
        return -side * max(stiffness * depth * (1.0 + loss * side * velocity), 0.0)
