"""Drag that grows with the square of the speed."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class QuadraticDrag(Effect):
    r"""A fluid brakes a body in proportion to the square of its speed: air, oil in a bore, water.

    .. math:: f \mathrel{+}= d\,v\,|v|

    Seen as: friction that rises ever faster with speed, the same in both directions.
    Not for: a rise in proportion to speed, which is viscous friction (see viscous_friction).
    Source: White (2011), Fluid Mechanics, 7th ed., section 7.6.
    """

    acts_on = "contact"
    drag = Parameter("friction/speed**2", 0.1, (0.0, 5.0), text="force for each square of the speed", off=0.0)

    @staticmethod
    def friction(velocity, speed, drag):
        """Drag."""
        return drag * velocity * speed
