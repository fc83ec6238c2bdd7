"""Seal friction that grows with line pressure."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class PressureFriction(Effect):
    r"""The water presses the two seals onto their cylinders, so static and Coulomb friction grow with the pressures.

    .. math:: F = F_0\,\Bigl(1 + s\,\frac{p_1 + p_2}{2}\Bigr)

    with 1 / s the contact pressure of the seals without water.
    Seen as: more friction at a higher preload, in both directions and at any speed.
    Not for: tests at one preload, where p1 + p2 hardly changes: static and Coulomb friction of both directions, which
    are those at 0 Pa gauge here, take it up together (their ratio to the published ones shows it).
    Source: Mueller & Nau (1998), Fluid Sealing Technology, chapter 4; Nikas (2010), Proc. IMechE J 224(1), 1-18,
    doi:10.1243/13506501JET607 (reciprocating seals).
    """

    subsystem = "joint"
    sensitivity = Parameter("1/Pa", 1e-6, (0.0, 5e-5), text="share of friction added by each pascal", off=0.0)

    @staticmethod
    def friction_static(friction_static, joint_pressure1, joint_pressure2, sensitivity):
        """Static friction under pressure, N."""
        return friction_static * max(0.0, 1.0 + sensitivity * 0.5 * (joint_pressure1 + joint_pressure2))

    @staticmethod
    def friction_coulomb(friction_coulomb, joint_pressure1, joint_pressure2, sensitivity):
        """Coulomb friction under pressure, N."""
        return friction_coulomb * max(0.0, 1.0 + sensitivity * 0.5 * (joint_pressure1 + joint_pressure2))
