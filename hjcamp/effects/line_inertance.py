"""Inertia of the water column in the tubing."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class LineInertance(Effect):
    r"""The water of the tubing moves faster than the sliders, so it weighs more than its mass.

    .. math:: m \mathrel{+}= 2\,(1 - b)\,I A_2^2, \quad p_{1,2}^{sensor} = p_{1,2} \pm b\,I\,\dot Q

    with I what is missing of rho L / A_i after the 4.0 g of water that the published mass holds already, and b its share
    between the sensor and the water that the line gives way to; Q is the flow from the pump, its rate taken over 4 ms.
    Seen as: more effective mass, 13 g for the published tubing, and a sensor that leads. With b = 0 alike but for its
    size: payload_inertia.
    Source: thesis 4.4.2.1, 4.5.2; White (2011), Fluid Mechanics, 7th ed., section 3.3.
    """

    subsystem = "lines"
    same_as = ("payload_inertia",)
    inertance = Parameter("kg/m^4", 4.2e7, (0.0, 2e9), text="inertance of one line beyond the published mass", off=0.0)
    sensor_share = Parameter("1", 0.0, (0.0, 1.0), text="share of it between sensor and line", shape=True)
    late_flow = State("m^3/s", 1e-10, 1e-6, text="flow from the pump some milliseconds ago")

    @staticmethod
    def start_late_flow(pump_flow):
        """Start with a steady flow, m^3/s."""
        return pump_flow

    @staticmethod
    def d_late_flow(pump_flow, late_flow, pump_a2):
        """Rate of the delayed flow, m^3/s^2."""
        return (pump_flow - late_flow) * pump_a2

    @staticmethod
    def mass(inertance, sensor_share, joint_area):
        """Effective mass added at the sliders, kg."""
        return 2.0 * (1.0 - sensor_share) * inertance * joint_area * joint_area

    @staticmethod
    def pressure1_reading(inertance, sensor_share, pump_flow, late_flow, pump_a2):
        """What sensor 1 shows more while the flow grows, Pa."""
        return sensor_share * inertance * (pump_flow - late_flow) * pump_a2

    @staticmethod
    def pressure2_reading(inertance, sensor_share, pump_flow, late_flow, pump_a2):
        """What sensor 2 shows less while the flow grows, Pa."""
        return -sensor_share * inertance * (pump_flow - late_flow) * pump_a2
