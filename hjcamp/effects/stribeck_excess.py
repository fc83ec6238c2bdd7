"""Static friction above Coulomb that fades with speed."""

from __future__ import annotations

from math import exp

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class StribeckExcess(Effect):
    r"""A contact sticks more than it slides, and what it sticks more fades as it starts to slide.

    .. math:: F_s \mathrel{+}= e, \quad F_c \mathrel{+}= e\,e^{-(v / v_s)^2}

    brings the excess e of static over Coulomb friction itself: for plants that have one dry friction for both.
    Seen as: a breakaway above what sliding needs, a force that falls with speed at low speed, stick-slip.
    Not for: contacts whose static friction is a parameter of its own (see stribeck_friction). No fluid film makes
    friction rise on breakaway: the excess cannot be negative. What fades over more than half the usual speed is no start of sliding:
    in addition to viscous friction it would be any bent curve of friction over speed.
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7.
    """

    acts_on = "contact"
    excess = Parameter("coulomb", 0.3, (0.0, 3.0), text="static friction above Coulomb friction", off=0.0)
    stribeck_speed = Parameter(
        "speed", 0.1, (5e-3, 0.5), "log-uniform", "speed at which the excess has fallen to 37 %", shape=True
    )

    @staticmethod
    def static(excess):
        """Excess of static friction."""
        return excess

    @staticmethod
    def coulomb(speed, excess, stribeck_speed):
        """What is left of the excess at this speed."""
        return excess * exp(-((speed / stribeck_speed) ** 2))
