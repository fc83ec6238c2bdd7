"""Gradual fall from static to Coulomb friction."""

from __future__ import annotations

from math import exp

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class StribeckFriction(Effect):
    r"""Friction falls gradually from static to Coulomb as the seal starts to slide.

    .. math:: f_c \mathrel{+}= (F_s - F_c)\, e^{-(\dot y / v_s)^2}

    Seen as: a force that falls with speed after breakaway; slower slips, overshoot after each stick.
    Not for: behaviour before breakaway (see presliding).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138.
    """

    subsystem = "joint"
    stribeck_velocity = Parameter(
        "m/s",
        6e-3,
        (5e-4, 5e-2),
        "log-uniform",
        "speed at which the extra friction has fallen to 37 %",
        shape=True,
        off=0.0,
    )

    @staticmethod
    def friction_coulomb(friction_coulomb, friction_static, speed, stribeck_velocity):
        """Friction at this speed without its viscous part, N."""
        return friction_coulomb + (friction_static - friction_coulomb) * exp(-((speed / stribeck_velocity) ** 2))
