"""Flow between the two lines."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class CrossLeakage(Effect):
    r"""Water passes from the line of higher pressure to the other one, in proportion to the difference.

    .. math:: q_{12} = G\,(p_1 - p_2)

    Seen as: the pressure difference decays while the sum of the pressures stays.
    Not for: loss to the outside, where the sum falls (see leakage), or pistons that slip (see pump_backlash).
    Source: laminar leakage flow, Merritt (1967), Hydraulic Control Systems, section 3.2; thesis 4.4.3.15.
    """

    subsystem = "lines"
    conductance = Parameter("m^3/(s*Pa)", 2e-15, (0.0, 1e-11), text="flow for each pascal of difference", off=0.0)

    @staticmethod
    def cross_flow(pressure1, pressure2, conductance):
        """Flow from line 1 to line 2, m^3/s."""
        return conductance * (pressure1 - pressure2)
