"""A force in proportion to the place."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Spring(Effect):
    r"""A spring pulls a body back to its rest position (a cable, a hose, a belt), or away from it (a beam that tips, a magnet).

    .. math:: F \mathrel{+}= -k\,(x - x_0)

    Seen as: a force that depends on the position alone, the same in both directions.
    Not for: a spring that stiffens (see cubic_spring) or acts beyond some travel only (see soft_stop).
    Source: Hooke's law, e.g. Den Hartog (1956), Mechanical Vibrations, section 2.1.
    """

    acts_on = "body"
    stiffness = Parameter(
        "force/position", 0.1, (-10.0, 10.0), text="force for each unit of travel; negative where it pushes away", off=0.0
    )
    rest_position = Parameter("position", 0.0, (-5.0, 5.0), text="position at which it pulls nothing", shape=True)

    @staticmethod
    def force(position, stiffness, rest_position):
        """Force of the spring."""
        return -stiffness * (position - rest_position)
