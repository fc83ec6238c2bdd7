"""Inertia of the water column in the tubing."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class LineInertance(Effect):
    r"""The water of the tubing moves faster than the sliders, so it weighs more than its mass.

    .. math:: p_{sensor} = p + f I \dot Q, \quad p_{joint} = p - (1 - f)\,I \dot Q, \quad
              Q = f A_1 \dot x + (1 - f) A_2 \dot y \;\Rightarrow\; m \mathrel{+}= 2\,(1 - f)^2 I A_2^2

    with I what is missing of rho L / A_i after the 4.0 g of water that the published mass holds already, and f the share of
    the line's compliance on the joint's side of it, as in line_resistance; rates of flows are taken over 4 ms.
    Seen as: more effective mass, 13 g for the published tubing with f = 0, and a sensor that leads. With f = 0 the same but
    for its size: payload_inertia.
    Source: thesis 4.4.2.1, 4.5.2; White (2011), Fluid Mechanics, 7th ed., section 3.3.
    """

    plant = "pump_joint"
    subsystem = "lines"
    same_as = ("payload_inertia",)
    inertance = Parameter("kg/m^4", 4.2e7, (0.0, 2e9), "log-normal", "inertance of one line beyond the published mass", off=0.0)
    far_share = Parameter("1", 0.0, (0.0, 1.0), text="share of the compliance on the joint's side of it", shape=True)
    late_pump_flow = State("m^3/s", 1e-10, 1e-6, text="flow from the pump some milliseconds ago")
    late_slider_flow = State("m^3/s", 1e-10, 1e-6, text="flow to the sliders some milliseconds ago")

    @staticmethod
    def start_late_pump_flow(pump_flow):
        """Start with a steady flow, m^3/s."""
        return pump_flow

    @staticmethod
    def start_late_slider_flow(slider_flow):
        """Start with a steady flow, m^3/s."""
        return slider_flow

    @staticmethod
    def d_late_pump_flow(pump_flow, late_pump_flow, pump_a2):
        """Rate of the delayed flow, m^3/s^2."""
        return (pump_flow - late_pump_flow) * pump_a2

    @staticmethod
    def d_late_slider_flow(slider_flow, late_slider_flow, pump_a2):
        """Rate of the delayed flow, m^3/s^2."""
        return (slider_flow - late_slider_flow) * pump_a2

    @staticmethod
    def mass(inertance, far_share, joint_area):
        """Effective mass added at the sliders, kg."""
        return 2.0 * (1.0 - far_share) ** 2 * inertance * joint_area * joint_area

    @staticmethod
    def joint_pressure1(inertance, far_share, pump_flow, late_pump_flow, pump_a2):
        """Pressure that joint cylinder 1 lacks while the flow from the pump grows, Pa."""
        return -(1.0 - far_share) * far_share * inertance * (pump_flow - late_pump_flow) * pump_a2

    @staticmethod
    def joint_pressure2(inertance, far_share, pump_flow, late_pump_flow, pump_a2):
        """Pressure that joint cylinder 2 then has in addition, Pa."""
        return (1.0 - far_share) * far_share * inertance * (pump_flow - late_pump_flow) * pump_a2

    @staticmethod
    def pressure1_reading(inertance, far_share, pump_flow, late_pump_flow, slider_flow, late_slider_flow, pump_a2):
        """What sensor 1 shows more while the flow grows, Pa."""
        flow = far_share * (pump_flow - late_pump_flow) + (1.0 - far_share) * (slider_flow - late_slider_flow)
        return far_share * inertance * flow * pump_a2

    @staticmethod
    def pressure2_reading(inertance, far_share, pump_flow, late_pump_flow, slider_flow, late_slider_flow, pump_a2):
        """What sensor 2 shows less while the flow grows, Pa."""
        flow = far_share * (pump_flow - late_pump_flow) + (1.0 - far_share) * (slider_flow - late_slider_flow)
        return -far_share * inertance * flow * pump_a2
