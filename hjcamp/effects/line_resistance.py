"""Pressure drop along the tubing."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class LineResistance(Effect):
    r"""Flow costs pressure along the tubing, whose wall yields along its whole length.

    .. math:: p_{sensor} = p + R \bigl(\tfrac13 A_1 \dot x + \tfrac16 A_2 \dot y\bigr), \quad
              p_{joint} = p - R \bigl(\tfrac16 A_1 \dot x + \tfrac13 A_2 \dot y\bigr), \quad
              R = \frac{128 \mu L}{\pi d_i^4}

    laminar; the flow falls evenly from that of the pump to that of the joint, p is the mean along the tube and the
    sensors stand at the pump.
    Seen as: a pressure error in step with pump speed, and viscous friction R A2^2 that both directions share. The
    published tubing has 2.3e8 Pa s/m^3: negligible; fittings and kinks have more.
    Not for: friction at the sliders; a rig whose sensors stand in the middle of its compliance cannot tell it from that.
    Source: thesis 4.4.1.2 (Reynolds number below 900); White (2011), Fluid Mechanics, 7th ed., section 6.4.
    """

    subsystem = "lines"
    resistance = Parameter("Pa*s/m^3", 2e10, (0.0, 2e12), text="pressure drop for each m^3/s in one line", off=0.0)

    @staticmethod
    def joint_pressure1(pump_flow, slider_flow, resistance):
        """Pressure that joint cylinder 1 lacks, Pa."""
        return -resistance * (pump_flow / 6.0 + slider_flow / 3.0)

    @staticmethod
    def joint_pressure2(pump_flow, slider_flow, resistance):
        """Pressure that joint cylinder 2 has in addition, Pa."""
        return resistance * (pump_flow / 6.0 + slider_flow / 3.0)

    @staticmethod
    def pressure1_reading(pump_flow, slider_flow, resistance):
        """Pressure that sensor 1 sees in addition, Pa."""
        return resistance * (pump_flow / 3.0 + slider_flow / 6.0)

    @staticmethod
    def pressure2_reading(pump_flow, slider_flow, resistance):
        """Pressure that sensor 2 sees less, Pa."""
        return -resistance * (pump_flow / 3.0 + slider_flow / 6.0)
