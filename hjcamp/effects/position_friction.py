"""Friction that changes with arm angle."""

from __future__ import annotations

from math import pi, sin

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class PositionFriction(Effect):
    r"""Static and Coulomb friction rise and fall along the travel: a bent rod, a groove, an uneven seal.

    .. math:: F \leftarrow F\,\bigl(1 + a \sin(2\pi\,\theta / \Theta + \varphi)\bigr)

    What depends on the angle comes again after a turn: periods are a turn or less.
    Seen as: a force that depends on arm angle and turns its sign with the direction of motion.
    Not for: a force with one sign in both directions (see gravity_load), or change with time (see friction_drift).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7; thesis 3.6 (rack and pinion: position-dependent friction).
    """

    subsystem = "joint"
    amplitude = Parameter("1", 0.2, (0.0, 0.9), text="largest change of friction over its mean", off=0.0)
    period = Parameter(
        "rad", 6.283185307179586, (0.3, 6.3), "log-uniform", "arm angle of one period, a turn or less", shape=True
    )
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="phase at arm angle 0", shape=True)

    @staticmethod
    def friction_static(friction_static, slider_angle, amplitude, period, phase):
        """Static friction at this angle, N."""
        return friction_static * (1.0 + amplitude * sin(2.0 * pi * slider_angle / period + phase))

    @staticmethod
    def friction_coulomb(friction_coulomb, slider_angle, amplitude, period, phase):
        """Coulomb friction at this angle, N."""
        return friction_coulomb * (1.0 + amplitude * sin(2.0 * pi * slider_angle / period + phase))
