"""Bristle friction before breakaway."""

from __future__ import annotations

from math import pi, sqrt

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class Presliding(Effect):
    r"""Before breakaway the seals give way like springs; friction falls once the whole contact slips.

    .. math:: \dot q_i = v\,(1 - r_i^2)\ \text{where}\ r_i v > 0,\ \text{else}\ v, \quad r_i = \frac{q_i}{c_i\,g}, \quad
              g = F_s - (F_s - F_c)\,w, \quad c_i = c\,(0.2,\ 1,\ 1.8)

    .. math:: f = h + d\,\dot q + C_v v, \quad h = \sum_i \frac{q_i}{3 c_i}, \quad
              \tau \dot w = \frac{s^2}{s^2 + v_s^2} - w, \quad s = |v|\,\min\Bigl(\frac{|h|}{g}, 1\Bigr)^n

    with three bristles that carry a third of the friction each and yield one after the other, over a decade of travel; slip
    s, weakness w, damping d = 2 (1 - w) sqrt(m / c) of their mean bending, and as memory tau the period of the slider on them.
    Breaks away at F_s, slides at F_c + C_v v. At rest the bristles carry the push: from there a test starts.
    Seen as: motion of some hundredths of a millimetre below breakaway, and its recovery when the force is taken off.
    Not for: the fall of friction at speeds far above v_s (see stribeck_friction).
    Source: elements that yield one by one: Iwan (1966), doi:10.1115/1.3625199; their friction: Al-Bender et al. (2005),
    doi:10.1109/TAC.2005.858676; no slip while unloading: Dupont et al. (2002), doi:10.1109/TAC.2002.1000274; memory: Hess
    & Soom (1990), doi:10.1115/1.2920239.
    """

    subsystem = "joint"
    compliance = Parameter(
        "m/N", 1e-5, (2e-6, 2e-4), "log-uniform", "mean deflection for each newton", shape=True, off=0.0
    )
    fall_velocity = Parameter(
        "m/s",
        5e-4,
        (5e-5, 2e-2),
        "log-uniform",
        "slip at which half of the extra static friction is gone",
        shape=True,
        off=0.0,
    )
    lateness = Parameter("1", 16.0, (0.0, 40.0), text="0: friction falls with any motion; large: with full slip only")
    deflection = State("m", 2e-8, 1e-5, text="deflection of the middle bristles", known=True)
    stiff_deflection = State("m", 2e-8, 1e-5, text="deflection of the stiff bristles", known=True)
    soft_deflection = State("m", 2e-8, 1e-5, text="deflection of the soft bristles", known=True)
    weakness = State("1", 1e-2, 1.0, text="share of the extra static friction that slip has taken", known=True)

    @staticmethod
    def start_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion, m."""
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_stiff_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion, m."""
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return 0.2 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_soft_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion, m."""
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return 1.8 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_weakness(speed):
        """Start weak in motion and healed at rest."""
        return 1.0 if speed > 0.0 else 0.0

    @staticmethod
    def d_deflection(deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        """Rate of the deflection, m/s."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = deflection / (compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_stiff_deflection(stiff_deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        """Rate of the deflection, m/s."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = stiff_deflection / (0.2 * compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_soft_deflection(soft_deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        """Rate of the deflection, m/s."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = soft_deflection / (1.8 * compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_weakness(
        deflection,
        stiff_deflection,
        soft_deflection,
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
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        slip = speed * min(abs(force) / level, 1.0) ** lateness
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
        stiff_deflection,
        soft_deflection,
        weakness,
        slider_velocity,
        friction_static,
        friction_coulomb,
        friction_viscous,
        moving_mass,
        compliance,
    ):
        """Friction of bristles and viscous film, N."""
        level = friction_static - (friction_static - friction_coulomb) * weakness
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        share = force / level
        elastic = slider_velocity * (1.0 - (min(share * share, 1.0) if slider_velocity * share > 0.0 else 0.0))
        damping = 2.0 * sqrt(moving_mass / compliance) * (1.0 - weakness)
        return force + damping * elastic + friction_viscous * slider_velocity
