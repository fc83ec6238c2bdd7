"""Inertia of the water column in the tubing."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class LineInertance(Effect):
    r"""The water of the tubing moves faster than the sliders, so it weighs more than its mass.

    .. math:: \Delta p = I\,\dot Q, \quad m \mathrel{+}= 2 I A_2^2

    with I what is missing of rho L / A_i after the 4.0 g of water that the published mass holds already.
    Seen as: more effective mass, 13 g for the published tubing. Alike but for its size: payload_inertia.
    Source: thesis 4.4.2.1, 4.5.2; White (2011), Fluid Mechanics, 7th ed., section 3.3.
    """

    subsystem = "lines"
    inertance = Parameter("kg/m^4", 4.2e7, (0.0, 2e9), text="inertance of one line beyond the published mass", off=0.0)

    @staticmethod
    def mass(inertance, joint_area):
        """Effective mass added at the sliders, kg."""
        return 2.0 * inertance * joint_area * joint_area
