"""A force that grows with the cube of the travel."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class CubicSpring(Effect):
    r"""A spring gets stiffer (or softer, where negative) the further it is bent: what makes an oscillator a Duffing one.

    .. math:: F \mathrel{+}= -k_3\,(x - x_0)^3

    Seen as: a force that depends on the position alone, small about its rest position and steep far from it.
    Not for: a spring of one stiffness (see spring), or nothing at all before some travel (see soft_stop).
    Source: Kovacic & Brennan (2011), The Duffing Equation: Nonlinear Oscillators and their Behaviour, chapter 2.
    """

    acts_on = "body"
    stiffness = Parameter("force/position**3", 0.1, (-10.0, 10.0), text="force for each cube of travel", off=0.0)
    rest_position = Parameter("position", 0.0, (-5.0, 5.0), text="position at which it pulls nothing", shape=True)

    @staticmethod
    def force(position, stiffness, rest_position):
        """Force of the spring."""
        bent = position - rest_position
        return -stiffness * bent * bent * bent
