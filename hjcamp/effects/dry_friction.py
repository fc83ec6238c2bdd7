"""Dry friction of a contact that the model has none of."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class DryFriction(Effect):
    r"""A contact rubs dry where the model has viscous friction alone.

    .. math:: F_s \mathrel{+}= F_0, \quad F_c \mathrel{+}= F_0

    Seen as: a motor that starts from a certain voltage on; a swing that dies by equal steps, not in equal proportions.
    Not for: contacts whose dry friction is in the model already: there it is a base parameter (calibrate).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30 (7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7, section 2.1.
    """

    acts_on = "contact"
    brings = "coulomb"
    level = Parameter("push", 0.05, (0.0, 2.0), text="dry friction, at rest and in motion", off=0.0)

    @staticmethod
    def static(level):
        """Static friction, N."""
        return level

    @staticmethod
    def coulomb(level):
        """Coulomb friction, N."""
        return level
