"""Mass on the arm."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class PayloadInertia(Effect):
    r"""A mass on the arm adds to the effective mass at the sliders.

    .. math:: m \mathrel{+}= m_l \frac{r^2}{r_p^2}

    Seen as: force in phase with acceleration, slower oscillation after each breakaway.
    Not for: weight (see gravity_load); the same but for its size: line_inertance.
    Source: thesis 4.5.2.1, 5.5.1 (8.5 g at 20 mm: 292 g).
    """

    plant = "pump_joint"
    subsystem = "joint"
    load_mass = Parameter("kg", 8.5e-3, (0.0, 0.5), "log-normal", "mass of the payload", off=0.0)
    radius = Parameter("m", 0.02, (1e-3, 0.2), text="distance of the payload from the axis")

    @staticmethod
    def mass(load_mass, radius, pulley_radius):
        """Effective mass added at the sliders, kg."""
        return load_mass * radius * radius / (pulley_radius * pulley_radius)
