"""Friction that changes along the travel."""

from __future__ import annotations

from math import expm1, pi, sin

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter


def along(friction, travel, amplitude, period, phase, concentration):
    """Return the friction at this place."""
    k = concentration if abs(concentration) > 1e-6 else 1e-6
    return friction * (1.0 + amplitude * expm1(k * sin(2.0 * pi * travel / period + phase)) * abs(k) / (k * expm1(abs(k))))


class PositionFriction(Effect):
    r"""Friction rises and falls along the travel: a bent rod, a groove, the turns of a screw, a burr.

    .. math:: F \leftarrow F\,(1 + a\,w), \quad C_v \leftarrow C_v\,(1 + b\,w), \quad
              w = \frac{e^{k s} - 1}{\mathrm{sgn}(k)\,(e^{|k|} - 1)}, \quad s = \sin(2\pi\,x / X + \varphi)

    with F static and Coulomb, C_v viscous friction. The curve w, one for both, is a sine where the concentration k is 0;
    above, a bump of width X / (2 pi sqrt(k)), the curve of von Mises; below, a dip.
    Seen as: a force that depends on the place and turns its sign with the direction of motion.
    Not for: a force with one sign in both directions (see spring), or change with time (see friction_drift).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7; the curve: Mardia & Jupp (2000), Directional Statistics, section 3.5.4.
    """

    acts_on = "contact"
    amplitude = Parameter("1", 0.2, (0.0, 0.9), text="largest change of dry friction over its mean", off=0.0)
    viscous_amplitude = Parameter("1", 0.0, (0.0, 0.9), text="largest change of viscous friction over its mean", off=0.0)
    period = Parameter("travel", 1.0, (0.02, 4.0), "log-uniform", "travel of one period", shape=True)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="phase at travel 0", shape=True)

    concentration = Parameter("1", 0.0, (-6.0, 6.0), text="0: a sine; above, a bump; below, a dip")

    @staticmethod
    def static(static, travel, amplitude, period, phase, concentration):
        """Static friction at this place."""
        return part(along, static, travel, amplitude, period, phase, concentration)

    @staticmethod
    def coulomb(coulomb, travel, amplitude, period, phase, concentration):
        """Coulomb friction at this place."""
        return part(along, coulomb, travel, amplitude, period, phase, concentration)

    @staticmethod
    def viscous(viscous, travel, viscous_amplitude, period, phase, concentration):
        """Viscous friction at this place."""
        return part(along, viscous, travel, viscous_amplitude, period, phase, concentration)
