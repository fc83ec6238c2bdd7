"""A flow that follows another power of the level."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class FlowExponent(Effect):
    r"""A flow follows another power of the level above it than the published one: an orifice that is partly laminar, a weir.

    .. math:: q \leftarrow q\,(h / h_0)^{e}

    with h_0 the level at which the published flow holds; below a millionth of that no power is taken.
    Seen as: a flow that is too large at low levels and too small at high ones, or the other way round.
    Not for: a flow that is wrong by one factor at every level, which is the path's own coefficient.
    Source: orifices (exponent 1/2) and laminar gaps (1): Merritt (1967), Hydraulic Control Systems, chapter 3.
    """

    acts_on = "path"
    exponent = Parameter("1", 0.1, (-0.5, 1.0), text="exponent added to that of the published law", off=0.0)
    reference = Parameter(
        "upstream", 1.0, (0.1, 10.0), "log-uniform", "level at which the published flow holds", shape=True
    )

    @staticmethod
    def flow(flow, upstream, exponent, reference):
        """Flow by the other power."""
        return flow * max(abs(upstream) / reference, 1e-6) ** exponent
