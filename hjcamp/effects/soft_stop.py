"""A spring beyond some travel."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class SoftStop(Effect):
    r"""Beyond some travel to either side a body meets an elastic stop.

    .. math:: F \mathrel{+}= -k\,\bigl(x - \min(\max(x,\ x_0 - w),\ x_0 + w)\bigr)

    with w the free travel to each side of the centre x_0; far from the travel of the tests one end is not met.
    Seen as: a force against the motion near the ends of the travel, none between them.
    Not for: a spring that acts everywhere (see spring), or a stop that also takes energy (see hard_stop).
    Source: piecewise-linear clearance, e.g. Shaw & Holmes (1983), Journal of Sound and Vibration 90(1), 129-155.
    """

    acts_on = "body"
    free_travel = Parameter("position", 0.8, (0.01, 10.0), "log-uniform", "travel to each side of the centre", shape=True)
    centre = Parameter("position", 0.0, (-10.0, 10.0), text="middle of the free travel", shape=True)
    stiffness = Parameter("force/position", 2.0, (0.0, 1e4), text="force for each unit of travel beyond it", off=0.0)

    @staticmethod
    def force(position, free_travel, centre, stiffness):
        """Force of the stops."""
        return stiffness * (max(centre - free_travel, min(centre + free_travel, position)) - position)
