"""A force that is always there."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class ConstantForce(Effect):
    r"""A body is pushed by a constant force: its weight on a slope, a preloaded seal, a zero error of the drive.

    .. math:: F \mathrel{+}= F_0

    Seen as: motion in one direction needs more force than in the other, by the same amount at every speed.
    Not for: friction that differs between the directions, which is gone at rest (see coulomb_asymmetry).
    Source: the offset of a drive's friction model, e.g. Janot, Gautier & Brunot (2019), Data Set and Reference Models of
    EMPS, Workshop on Nonlinear System Identification Benchmarks.
    """

    acts_on = "body"
    strength = Parameter("force", 0.05, (-2.0, 2.0), text="the force, positive in the positive direction", off=0.0)

    @staticmethod
    def force(strength):
        """The constant force."""
        return strength
