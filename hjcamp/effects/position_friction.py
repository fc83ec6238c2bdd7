"""Friction that changes along the travel."""

from __future__ import annotations

from math import pi, sin

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class PositionFriction(Effect):
    r"""Static and Coulomb friction rise and fall along the travel: a bent rod, a groove, the turns of a screw.

    .. math:: F \leftarrow F\,\bigl(1 + a \sin(2\pi\,x / X + \varphi)\bigr)

    Seen as: a force that depends on the place and turns its sign with the direction of motion.
    Not for: a force with one sign in both directions (see spring), or change with time (see friction_drift).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7.
    """

    acts_on = "contact"
    scatters = True
    amplitude = Parameter("1", 0.2, (0.0, 0.9), text="largest change of friction over its mean", off=0.0)
    period = Parameter("travel", 1.0, (0.02, 4.0), "log-uniform", "travel of one period", shape=True)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="phase at travel 0", shape=True)

    @staticmethod
    def static(static, travel, amplitude, period, phase):
        """Static friction at this place."""
        return static * (1.0 + amplitude * sin(2.0 * pi * travel / period + phase))

    @staticmethod
    def coulomb(coulomb, travel, amplitude, period, phase):
        """Coulomb friction at this place."""
        return coulomb * (1.0 + amplitude * sin(2.0 * pi * travel / period + phase))
