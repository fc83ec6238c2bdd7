"""Inertia of what flows in a line."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class FlowInertance(Effect):
    r"""What flows in a line has mass: while the flow grows, less of the pressure of a store arrives at what it pushes.

    .. math:: p_2 = p_1 - I\,\frac{q - q_l}{\tau}, \quad \tau\,\dot q_l = q - q_l

    with I = rho L / A of a tube. The rate of the flow is that over the time tau: slower than it this is I dq/dt, and a body of area A_b
    that is pushed weighs I A_b^2 more; faster, the column moves as against a damper I / tau.
    Seen as: more mass than moves by itself, slower oscillations after each stop.
    Not for: a mass on the body (see added_mass): where a line pushes one body alone, that is the same but for its size.
    Source: White (2011), Fluid Mechanics, 7th ed., section 3.3; Merritt (1967), Hydraulic Control Systems, section 2.6.
    """

    acts_on = "line"
    together = True
    same_as = ("added_mass",)
    inertance = Parameter("level*period/flow", 0.05, (0.0, 100.0), text="loss for each unit of the rate of the flow", off=0.0)
    rise = Parameter("period", 4.0, (2.0, 20.0), text="time over which the rate of the flow is taken")
    late = State("flow", 1e-5, text="flow some samples ago")

    @staticmethod
    def start_late(flow):
        """Start with a steady flow."""
        return flow

    @staticmethod
    def d_late(flow, late, rise):
        """Rate of the flow some samples ago."""
        return (flow - late) / rise

    @staticmethod
    def far(flow, late, inertance, rise):
        """What the far end lacks while the flow grows."""
        return -inertance * (flow - late) / rise
