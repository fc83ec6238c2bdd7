"""A flow that follows another power of what drives it."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class FlowExponent(Effect):
    r"""A flow follows another power of its head than the published one: an orifice that is partly laminar, a weir.

    .. math:: q \leftarrow q\,(|h| / h_0)^{e}

    with the head h, the level upstream less that downstream where the path has one, and h_0 that at which the published flow
    holds; below a millionth of it no power is taken.
    Seen as: a flow that is too large at low heads and too small at high ones, or the other way round.
    Not for: a flow that is wrong by one factor at every head, which is the path's own coefficient.
    Source: orifices (exponent 1/2) and laminar gaps (1): Merritt (1967), Hydraulic Control Systems, chapter 3.
    """

    acts_on = "path"
    exponent = Parameter("1", 0.1, (-0.5, 1.0), text="exponent added to that of the published law", off=0.0)
    reference = Parameter("head", 1.0, (0.1, 10.0), "log-uniform", "head at which the published flow holds", shape=True)

    @staticmethod
    def flow(flow, head, exponent, reference):
        """Flow by the other power."""
        return flow * max(abs(head) / reference, 1e-6) ** exponent
