"""Viscous friction of a contact that the model has none of."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class ViscousFriction(Effect):
    r"""A contact brakes in proportion to speed where the model has none of that: grease, a bearing, an eddy current, a back voltage.

    .. math:: C \mathrel{+}= C_0

    Seen as: a swing that dies by equal proportions; a machine that runs up to a speed and no further; friction that rises with speed.
    Not for: contacts whose viscous friction is in the model already: there it is a base parameter (calibrate).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30 (7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7, section 2.1.
    """

    acts_on = "contact"
    brings = "viscous"
    coefficient = Parameter("push/velocity", 0.1, (0.0, 2.0), text="force for each unit of speed", off=0.0)

    @staticmethod
    def viscous(coefficient):
        """Viscous friction, force for each unit of speed."""
        return coefficient
