"""Viscous friction that differs between the directions."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class ViscousAsymmetry(Effect):
    r"""Viscous friction is larger in one direction than in the other.

    .. math:: C \leftarrow C\,(1 + a\,\mathrm{sign}\,v)

    Seen as: friction that differs between the directions the more, the faster the motion.
    Not for: a difference that is there at every speed (see coulomb_asymmetry).
    Source: Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    acts_on = "contact"
    works_on = "viscous"
    asymmetry = Parameter("1", 0.2, (-0.9, 0.9), text="share more in the positive direction, less in the other", off=0.0)

    @staticmethod
    def viscous(viscous, velocity, asymmetry):
        """Viscous friction of this direction."""
        return viscous * (1.0 + (asymmetry if velocity > 0.0 else -asymmetry))
