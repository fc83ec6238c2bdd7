"""A path that lets flow pass in one direction more easily than in the other."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class CheckValve(Effect):
    r"""A path holds flow back in one direction: a check valve, a diode, a driver that cannot brake its motor.

    .. math:: q \leftarrow q\,(1 - b)\ \text{where}\ q < 0

    Seen as: a level that rises as computed and falls more slowly, or a motor that is not braked by its own voltage.
    Not for: a flow that is less in both directions, which is the path's own coefficient.
    Source: Merritt (1967), Hydraulic Control Systems, chapter 4 (check valves); Horowitz & Hill (2015), The Art of
    Electronics, 3rd ed., section 1.6 (diodes).
    """

    acts_on = "path"
    blocked = Parameter("1", 0.5, (0.0, 1.0), text="share of the flow against the path's direction that is held back", off=0.0)

    @staticmethod
    def flow(flow, blocked):
        """Flow that is let through."""
        return flow * (1.0 - blocked) if flow < 0.0 else flow
