"""Pressure drop along the tubing."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class LineResistance(Effect):
    r"""Flow towards the joint costs pressure between the sensor, at the pump, and the joint cylinder.

    .. math:: p_{joint} = p \mp R\,Q, \quad Q = A_2 \dot y, \quad R = \frac{128 \mu L}{\pi d_i^4}

    laminar; the volume that yields is on the pump's side of the resistance.
    Seen as: viscous friction 2 R A2^2, equal in both directions; 6 N s/m here. Where sensors stand at the pump only,
    these tests cannot tell it from viscous friction. The published tubing has 2.3e8 Pa s/m^3: negligible.
    Source: thesis 4.4.1.2 (Reynolds number below 900); White (2011), Fluid Mechanics, 7th ed., section 6.4.
    """

    subsystem = "lines"
    resistance = Parameter("Pa*s/m^3", 2e10, (0.0, 2e12), text="pressure drop for each m^3/s in one line", off=0.0)

    @staticmethod
    def joint_pressure1(slider_flow, resistance):
        """Pressure that joint cylinder 1 lacks, Pa."""
        return -resistance * slider_flow

    @staticmethod
    def joint_pressure2(slider_flow, resistance):
        """Pressure that joint cylinder 2 has in addition, Pa."""
        return resistance * slider_flow
