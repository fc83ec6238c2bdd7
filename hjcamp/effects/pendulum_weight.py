"""The weight of a body that hangs."""

from __future__ import annotations

from math import sin

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class PendulumWeight(Effect):
    r"""Its weight turns a body towards the angle where its centre of mass hangs straight down.

    .. math:: M \mathrel{+}= -m g r\,\sin(\theta - \theta_0)

    Seen as: a torque that depends on the angle alone, the same in both directions.
    Not for: a spring, which goes on growing with the angle (see spring), or a body that moves along a line (constant_force).
    Source: the compound pendulum, e.g. Goldstein, Poole & Safko (2002), Classical Mechanics, 3rd ed., chapter 1.
    """

    acts_on = "body"
    only_in = {"angle": ("rad",)}  # noqa: RUF012
    moment = Parameter("force", 0.1, (0.0, 10.0), text="weight times its distance from the axis", off=0.0)
    rest_angle = Parameter("rad", 0.0, (-3.2, 3.2), text="angle at which it hangs straight down", shape=True)

    @staticmethod
    def force(angle, moment, rest_angle):
        """Torque of the weight, or its force along the body's way."""
        return -moment * sin(angle - rest_angle)
