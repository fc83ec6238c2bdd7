"""Loss from a store to the outside."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Leakage(Effect):
    r"""A store loses to the outside, in proportion to its level and faster above a threshold.

    .. math:: q_{leak} = G\,p + G_t \max(p - p_t, 0)

    Seen as: levels that fall with time, most at rest and where they are high; a temperature falls so towards that of the room.
    Not for: what goes to another store (see cross_leakage), or spills over a brim at once (see overflow).
    Source: laminar leakage flow, Merritt (1967), Hydraulic Control Systems, section 3.2.
    """

    acts_on = "store"
    together = True
    conductance = Parameter("loss/level", 0.02, (0.0, 10.0), text="flow for each unit of level", off=0.0)
    threshold = Parameter("level", 1.0, (0.0, 4.0), text="level above which more is lost", shape=True)
    conductance_above = Parameter("loss/level", 0.1, (0.0, 10.0), text="further flow for each unit above it", off=0.0)

    @staticmethod
    def loss(level, conductance, threshold, conductance_above):
        """Flow lost."""
        return conductance * level + conductance_above * max(level - threshold, 0.0)
