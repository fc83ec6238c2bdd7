"""Dry friction that differs between the directions."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter


def of_direction(friction, direction, push, asymmetry):
    """Return the friction of the direction in which it moves or is pushed."""
    forward = direction > 0.0 or (direction == 0.0 and push > 0.0)
    return friction * (1.0 + (asymmetry if forward else -asymmetry))


class CoulombAsymmetry(Effect):
    r"""Static and Coulomb friction are larger in one direction than in the other.

    .. math:: F \leftarrow F\,(1 + a\,\mathrm{sign}\,v)

    at rest with the sign of the push.
    Seen as: friction that differs between the directions by the same amount at every speed, and breakaways that do.
    Not for: a force that also acts at rest (see constant_force).
    Source: Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    acts_on = "contact"
    works_on = "coulomb"
    asymmetry = Parameter("1", 0.1, (-0.9, 0.9), text="share more in the positive direction, less in the other", off=0.0)

    @staticmethod
    def static(static, direction, push, asymmetry):
        """Static friction of the direction in which it is pushed."""
        return part(of_direction, static, direction, push, asymmetry)

    @staticmethod
    def coulomb(coulomb, direction, push, asymmetry):
        """Coulomb friction of this direction."""
        return part(of_direction, coulomb, direction, push, asymmetry)
