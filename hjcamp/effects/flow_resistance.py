"""Loss of level along a line by the flow in it."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class FlowResistance(Effect):
    r"""Flow costs level along a line: of the pressure of a store less arrives at what it pushes.

    .. math:: p_2 = p_1 - R\,q - k\,q\,|q|

    with R of a laminar tube 128 mu L / (pi d^4), k of a fitting, a kink or an orifice zeta rho / (2 A^2).
    Seen as: a force in step with the speed of what is pushed (its square), though nothing rubs there.
    Not for: what rubs whatever pushes it (see viscous_friction): where a line pushes one body alone, R is the same as that.
    Source: White (2011), Fluid Mechanics, 7th ed., sections 6.4 and 6.9.
    """

    acts_on = "line"
    together = True
    same_as = ("viscous_friction",)
    resistance = Parameter("level/flow", 0.02, (0.0, 10.0), text="loss for each unit of flow", off=0.0)
    turbulent = Parameter("level/flow**2", 0.0, (0.0, 10.0), text="further loss for its square", off=0.0)

    @staticmethod
    def far(flow, resistance, turbulent):
        """What the far end lacks."""
        return -(resistance + turbulent * abs(flow)) * flow
