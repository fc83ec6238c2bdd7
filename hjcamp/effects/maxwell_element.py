"""A spring in series with a damper, in addition to what holds a body."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class MaxwellElement(Effect):
    r"""What holds a body relaxes: a spring in series with a damper pulls at it, in addition to what is there.

    .. math:: F \mathrel{+}= -k\,(x - x_r), \quad \tau\,\dot x_r = x - x_r

    Rubber, a polymer, a fluid behind a compliance: stiff where it moves fast, without force where it rests, with the damping k tau.
    Seen as: a force that fades at rest after each step; more damping in slow motion than in fast motion.
    Not for: a force that stays (see spring), or one in proportion to the speed at any speed (see viscous_friction).
    Source: the standard linear solid, e.g. Ferry (1980), Viscoelastic Properties of Polymers, 3rd ed., section 1.B.
    """

    acts_on = "body"
    stiffness = Parameter("force/position", 0.1, (0.0, 10.0), text="force for each unit of a quick step", off=0.0)
    relaxation = Parameter("period", 50.0, (1.0, 1e4), "log-uniform", "time in which the force fades at rest", shape=True)
    relaxed = State("position", 1e-5, text="position at which it pulls nothing")

    @staticmethod
    def start_relaxed(position):
        """Start without force."""
        return position

    @staticmethod
    def d_relaxed(position, relaxed, relaxation):
        """Rate of the position at which it pulls nothing."""
        return (position - relaxed) / relaxation

    @staticmethod
    def force(position, relaxed, stiffness):
        """Force of the element."""
        return -stiffness * (position - relaxed)
