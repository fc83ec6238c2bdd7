"""Mass that a body carries in addition."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class AddedMass(Effect):
    r"""A body carries more mass than its model: a payload, a tool, the water that moves with it.

    .. math:: m \mathrel{+}= m_a

    Seen as: a force in phase with the acceleration, slower oscillations after each stop.
    Not for: weight (see pendulum_weight, constant_force); where the mass is a base parameter, that takes it up.
    Source: Newton's second law; of a fluid that moves with a body: White (2011), Fluid Mechanics, 7th ed., section 8.9.
    """

    acts_on = "body"
    without_base = "mass"
    added = Parameter("mass", 0.1, (0.0, 10.0), text="mass in addition, or moment of inertia", off=0.0)

    @staticmethod
    def mass(added):
        """Mass in addition."""
        return added
