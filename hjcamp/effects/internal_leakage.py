"""Flow from one store to another one that no path joins."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class InternalLeakage(Effect):
    r"""Between two stores something leaks that should not: past a piston, through a wall, in proportion to the difference.

    .. math:: q_{1} \mathrel{-}= G\,(p_1 - p_2), \quad q_{2} \mathrel{+}= G\,(p_1 - p_2)

    Seen as: one level falls while the other rises, the faster the further they are apart; both together stay.
    Not for: loss to the outside, where one falls alone (see leakage), or flow past a path that is there (see cross_leakage).
    Source: laminar leakage past a piston, Merritt (1967), Hydraulic Control Systems, sections 3.2 and 6.1.
    """

    acts_on = "partition"
    conductance = Parameter("loss/level", 0.02, (0.0, 10.0), text="flow for each unit of difference", off=0.0)

    @staticmethod
    def loss(level, level_beyond, conductance):
        """What the first store loses."""
        return conductance * (level - level_beyond)

    @staticmethod
    def loss_beyond(level, level_beyond, conductance):
        """What the other store loses."""
        return conductance * (level_beyond - level)
