"""Flow past a path."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class CrossLeakage(Effect):
    r"""Some flow takes another way than the path, in proportion to the difference of the levels at its ends.

    .. math:: q \mathrel{+}= G\,(p_1 - p_2)

    Seen as: the difference between both sides decays while what they hold together stays.
    Not for: loss to the outside, where both fall (see leakage).
    Source: laminar leakage flow, Merritt (1967), Hydraulic Control Systems, section 3.2.
    """

    acts_on = "path"
    conductance = Parameter("flow/upstream", 0.02, (0.0, 10.0), text="flow for each unit of difference", off=0.0)

    @staticmethod
    def flow(upstream, downstream, conductance):
        """Flow past the path."""
        return conductance * (upstream - downstream)
