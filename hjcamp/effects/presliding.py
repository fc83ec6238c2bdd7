"""Bristle friction before breakaway."""

from __future__ import annotations

from math import pi, sqrt

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class Presliding(Effect):
    r"""Before breakaway the seals give way like springs; friction falls once the whole contact slips.

    .. math:: \dot q = v - |v|\,\frac{q}{c\,g}, \quad g = F_s - (F_s - F_c)\,w, \quad
              \tau \dot w = \frac{s^2}{s^2 + v_s^2} - w, \quad s = |v|\,\Bigl(\frac{|q|}{c\,g}\Bigr)^n,

    .. math:: f = \frac{q}{c} + 2 \sqrt{\frac{m}{c}}\,(1 - w)\,\dot q + C_v v

    with slip s, weakness w, and as memory tau the period of the slider on its bristles; n = 0 is LuGre with memory. Breaks
    away at F_s, slides at F_c + C_v v. At rest the bristles carry the push: from there a test starts.
    Seen as: motion of some hundredths of a millimetre below breakaway, and its recovery when the force is taken off.
    Not for: the fall of friction at speeds far above v_s (see stribeck_friction).
    Source: Canudas de Wit et al. (1995), IEEE Trans. Autom. Control 40(3), 419-425, doi:10.1109/9.376053; slip told
    from bending: Dupont et al. (2002), doi:10.1109/TAC.2002.1000274; memory: Hess & Soom (1990), doi:10.1115/1.2920239.
    """

    subsystem = "joint"
    compliance = Parameter("m/N", 1e-5, (2e-6, 2e-4), "log-uniform", "deflection for each newton", shape=True, off=0.0)
    fall_velocity = Parameter(
        "m/s",
        5e-4,
        (5e-5, 2e-2),
        "log-uniform",
        "slip at which half of the extra static friction is gone",
        shape=True,
        off=0.0,
    )
    lateness = Parameter(
        "1", 16.0, (0.0, 40.0), text="0: friction falls with any motion (LuGre); large: with full slip only"
    )
    deflection = State("m", 2e-8, 1e-5, text="deflection of the bristles", known=True)
    weakness = State("1", 1e-2, 1.0, text="share of the extra static friction that slip has taken", known=True)

    @staticmethod
    def start_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion, m."""
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_weakness(speed):
        """Start weak in motion and healed at rest."""
        return 1.0 if speed > 0.0 else 0.0

    @staticmethod
    def d_deflection(deflection, weakness, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        """Rate of the deflection, m/s."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        return slider_velocity - speed * deflection / (compliance * level)

    @staticmethod
    def d_weakness(
        deflection,
        weakness,
        speed,
        friction_static,
        friction_coulomb,
        moving_mass,
        compliance,
        fall_velocity,
        lateness,
    ):
        """Rate of the weakness, 1/s."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        slip = speed * min(abs(deflection) / (compliance * level), 1.0) ** lateness
        return (slip * slip / (slip * slip + fall_velocity * fall_velocity) - weakness) / (
            2.0 * pi * sqrt(moving_mass * compliance)
        )

    @staticmethod
    def friction_locks(friction_locks):
        """0: the bristles hold the slider, not the rigid lock."""
        return 0.0 * friction_locks

    @staticmethod
    def friction(
        friction,
        deflection,
        weakness,
        slider_velocity,
        speed,
        friction_static,
        friction_coulomb,
        friction_viscous,
        moving_mass,
        compliance,
    ):
        """Friction of bristles and viscous film, N."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        elastic = slider_velocity - speed * deflection / (compliance * level)
        damping = 2.0 * sqrt(moving_mass / compliance) * (1.0 - weakness)
        return deflection / compliance + damping * elastic + friction_viscous * slider_velocity
