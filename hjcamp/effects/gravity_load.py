"""Weight on the arm of a vertical joint."""

from __future__ import annotations

from math import sin

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class GravityLoad(Effect):
    r"""The weight of a payload turns the arm towards the angle where it hangs straight down.

    .. math:: F_{load} = -\frac{m g r}{r_p} \sin(\theta_a - \theta_0)

    Seen as: a force that depends on arm angle alone, the same in both directions.
    Not for: a spring, which goes on growing with the angle.
    Source: thesis 5.5 and Figure 5.5.9 (8.5 g at 20 mm: 0.49 N at the sliders).
    """

    plant = "pump_joint"
    subsystem = "joint"
    exact_in = ("arm_angle",)
    load_mass = Parameter("kg", 8.5e-3, (0.0, 0.5), text="mass of the payload", off=0.0)
    radius = Parameter("m", 0.02, (1e-3, 0.2), text="distance of the payload from the axis")
    rest_angle = Parameter("rad", 0.0, (-3.2, 3.2), text="arm angle at which the payload hangs straight down", shape=True)

    @staticmethod
    def load_force(arm_angle, pulley_radius, load_mass, radius, rest_angle):
        """Force on the sliders, N."""
        return -load_mass * 9.81 * radius / pulley_radius * sin(arm_angle - rest_angle)
