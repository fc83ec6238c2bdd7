"""Loss of water from each line to the outside."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class Leakage(Effect):
    r"""Water is lost from each line, in proportion to its pressure and faster above a threshold.

    .. math:: q_{leak} = G\,p + G_t \max(p - p_t, 0)

    Seen as: both pressures fall with time, most at rest under high pressure.
    Not for: water that comes back (see tubing_creep) or that goes to the other line (see cross_leakage).
    Source: thesis 4.4.4 (0.03 MPa/s at 0.62 MPag, below 0.5 %/s under 0.58 MPag).
    """

    subsystem = "lines"
    conductance = Parameter("m^3/(s*Pa)", 2e-16, (0.0, 1e-11), text="flow for each pascal of line pressure", off=0.0)
    threshold = Parameter("Pa", 0.59e6, (0.0, 2e6), text="pressure above which the fittings open", shape=True)
    conductance_above = Parameter("m^3/(s*Pa)", 3.9e-14, (0.0, 1e-11), text="further flow per pascal above it", off=0.0)

    @staticmethod
    def leak1(pressure1, conductance, threshold, conductance_above):
        """Flow lost from line 1, m^3/s."""
        return conductance * pressure1 + conductance_above * max(pressure1 - threshold, 0.0)

    @staticmethod
    def leak2(pressure2, conductance, threshold, conductance_above):
        """Flow lost from line 2, m^3/s."""
        return conductance * pressure2 + conductance_above * max(pressure2 - threshold, 0.0)
