"""Gradual fall from static to Coulomb friction."""

from __future__ import annotations

from math import exp

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class StribeckFriction(Effect):
    r"""Friction falls gradually from static to Coulomb as a contact starts to slide.

    .. math:: f_c \mathrel{+}= (F_s - F_c)\, e^{-(v / v_s)^2}

    Seen as: a force that falls with speed after breakaway; slower slips, overshoot after each stick.
    Not for: contacts without a static friction of their own (see stribeck_excess), or before breakaway (see presliding).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138.
    """

    acts_on = "contact"
    stribeck_velocity = Parameter(
        "speed",
        0.1,
        (5e-3, 2.0),
        "log-uniform",
        "speed at which the extra friction has fallen to 37 %",
        shape=True,
        off=0.0,
    )

    @staticmethod
    def coulomb(coulomb, breakaway, speed, stribeck_velocity):
        """Friction at this speed without its viscous part."""
        return coulomb + (breakaway - coulomb) * exp(-((speed / stribeck_velocity) ** 2))
