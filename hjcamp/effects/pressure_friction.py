"""Seal friction that grows with line pressure."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter


def loaded(friction, joint_pressure1, joint_pressure2, coefficient, reference):
    """Return the friction with the pressures on the seals, a fifth of the base at least, N."""
    added = coefficient * (max(joint_pressure1 + joint_pressure2, 0.0) - reference)
    return max(friction + added, 0.2 * friction)


class PressureFriction(Effect):
    r"""The water presses the seals of both pistons onto their cylinders, so friction grows with the pressures.

    .. math:: F = F_0 + c\,(p_1 + p_2 - p_0)

    for static and Coulomb friction equally, with c the coefficient of seal friction times the seal's contact area and p_0 the
    sum at which the base friction holds.
    Seen as: the same added friction at a higher preload, in both directions and at any speed.
    Not for: tests at one preload, where p1 + p2 hardly changes: static and Coulomb friction of both directions take it
    up together.
    Source: Mueller & Nau (1998), Fluid Sealing Technology, chapter 4; Nikas (2010), Proc. IMechE J 224(1), 1-23,
    doi:10.1243/13506501JET607 (reciprocating seals).
    """

    plant = "pump_joint"
    subsystem = "joint"
    coefficient = Parameter("N/Pa", 1e-6, (0.0, 5e-5), text="friction added by each pascal of p1 + p2", off=0.0)
    reference = Parameter("Pa", 0.52e6, (0.2e6, 1.5e6), text="p1 + p2 at which base friction holds (published preload)")

    @staticmethod
    def friction_static(friction_static, joint_pressure1, joint_pressure2, coefficient, reference):
        """Static friction with the pressures on the seals, a fifth of the base at least, N."""
        return part(loaded, friction_static, joint_pressure1, joint_pressure2, coefficient, reference)

    @staticmethod
    def friction_coulomb(friction_coulomb, joint_pressure1, joint_pressure2, coefficient, reference):
        """Coulomb friction with the pressures on the seals, a fifth of the base at least, N."""
        return part(loaded, friction_coulomb, joint_pressure1, joint_pressure2, coefficient, reference)
