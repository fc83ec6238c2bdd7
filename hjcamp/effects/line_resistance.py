"""Pressure drop along the tubing."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class LineResistance(Effect):
    r"""Flow costs pressure between the pump's end of a line and the joint's.

    .. math:: p_{sensor} = p + f \Delta, \quad p_{joint} = p - (1 - f) \Delta, \quad \Delta = R\,Q + k\,Q\,|Q|, \quad
              \tau \dot Q = f A_1 \dot x + (1 - f) A_2 \dot y - Q, \quad \tau = f (1 - f) (R + 2 k |Q|) / K

    between two vessels that share the compliance of the line, K its stiffness; f is the share on the joint's side
    of the resistance, p the mean pressure, and the sensors stand at the pump. A smooth tube has f = 1/2, a fitting at the
    pump 1, one at the joint 0. Laminar flow has R = 128 mu L / (pi d^4) alone; a fitting or a kink has k = zeta rho / (2 A^2).
    Seen as: a pressure error in step with pump speed (its square), and viscous friction (1 - f)^2 R A2^2 that both directions share.
    The published tubing has 2.3e8 Pa s/m^3: negligible; fittings and kinks have more.
    Not for: friction at the sliders; with f = 0 nothing tells it from that.
    Source: thesis 4.4.1.2 (Reynolds number below 900); White (2011), Fluid Mechanics, 7th ed., sections 6.4 and 6.9.
    """

    plant = "pump_joint"
    subsystem = "lines"
    resistance = Parameter("Pa*s/m^3", 2e10, (0.0, 2e12), text="pressure drop for each m^3/s in one line", off=0.0)
    far_share = Parameter("1", 0.5, (0.0, 1.0), text="share of the compliance on the joint's side of it")
    turbulent = Parameter("Pa*s^2/m^6", 0.0, (0.0, 5e18), text="further drop for its square, of fittings and kinks", off=0.0)
    tube_flow = State("m^3/s", 1e-10, 1e-6, text="flow past the resistance")

    @staticmethod
    def start_tube_flow(pump_flow, slider_flow, far_share):
        """Start with a steady flow, m^3/s."""
        return far_share * pump_flow + (1.0 - far_share) * slider_flow

    @staticmethod
    def d_tube_flow(pump_flow, slider_flow, tube_flow, resistance, turbulent, far_share, line_stiffness):
        """Rate of the flow past the resistance, m^3/s^2; a lag below 0.1 ms is not resolved."""
        slope = resistance + 2.0 * turbulent * abs(tube_flow)
        lag = max(slope * far_share * (1.0 - far_share) / line_stiffness, 1e-4)
        return (far_share * pump_flow + (1.0 - far_share) * slider_flow - tube_flow) / lag

    @staticmethod
    def joint_pressure1(tube_flow, resistance, turbulent, far_share):
        """Pressure that joint cylinder 1 lacks, Pa."""
        return -(1.0 - far_share) * (resistance + turbulent * abs(tube_flow)) * tube_flow

    @staticmethod
    def joint_pressure2(tube_flow, resistance, turbulent, far_share):
        """Pressure that joint cylinder 2 has in addition, Pa."""
        return (1.0 - far_share) * (resistance + turbulent * abs(tube_flow)) * tube_flow

    @staticmethod
    def pressure1_reading(tube_flow, resistance, turbulent, far_share):
        """Pressure that sensor 1 sees in addition, Pa."""
        return far_share * (resistance + turbulent * abs(tube_flow)) * tube_flow

    @staticmethod
    def pressure2_reading(tube_flow, resistance, turbulent, far_share):
        """Pressure that sensor 2 sees less, Pa."""
        return -far_share * (resistance + turbulent * abs(tube_flow)) * tube_flow
