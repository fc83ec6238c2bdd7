"""Bristle friction before breakaway."""

from __future__ import annotations

from math import pi, sqrt

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class Presliding(Effect):
    r"""Before breakaway a contact gives way like springs; friction falls once the whole of it slips.

    .. math:: \dot q_i = v\,(1 - r_i^2)\ \text{where}\ r_i v > 0,\ \text{else}\ v, \quad r_i = \frac{q_i}{c_i\,g}, \quad
              g = F_s - (F_s - F_c)\,w, \quad c_i = c\,(0.2,\ 1,\ 1.8)

    .. math:: f = h + d\,\dot q + C_v v, \quad h = \sum_i \frac{q_i}{3 c_i}, \quad
              \tau \dot w = \frac{s^2}{s^2 + v_s^2} - w, \quad s = |v|\,\min\Bigl(\frac{|h|}{g}, 1\Bigr)^n

    with three bristles that carry a third of the friction each and yield one after the other, over a decade of travel; slip
    s, weakness w, damping d = 2 (1 - w) sqrt(m / c) of their mean bending, and as memory tau the period of the mass on them.
    Breaks away at F_s, slides at F_c + C_v v. At rest the bristles carry the push: from there a test starts.
    Seen as: a small motion below breakaway, and its recovery when the force is taken off; no jump at a reversal.
    Not for: the fall of friction at speeds far above v_s (see stribeck_friction, stribeck_excess).
    Source: elements that yield one by one: Iwan (1966), doi:10.1115/1.3625199; their friction: Al-Bender et al. (2005),
    doi:10.1109/TAC.2005.858676; no slip while unloading: Dupont et al. (2002), doi:10.1109/TAC.2002.1000274; memory: Hess
    & Soom (1990), doi:10.1115/1.2920239.
    """

    acts_on = "contact"
    works_on = "coulomb"
    granted = "compliance"
    compliance = Parameter(
        "velocity*period/static",
        1.0,
        (0.02, 100.0),
        "log-uniform",
        "mean deflection for each unit of force",
        shape=True,
        off=0.0,
    )
    fall_velocity = Parameter(
        "speed",
        0.05,
        (5e-3, 2.0),
        "log-uniform",
        "slip at which half of the extra static friction is gone",
        shape=True,
        off=0.0,
    )
    lateness = Parameter("1", 16.0, (0.0, 40.0), text="0: friction falls with any motion; large: with full slip only")
    deflection = State("velocity*period", 2e-3, text="deflection of the middle bristles", known=True)
    stiff_deflection = State("velocity*period", 2e-3, text="deflection of the stiff bristles", known=True)
    soft_deflection = State("velocity*period", 2e-3, text="deflection of the soft bristles", known=True)
    weakness = State("1", 1e-2, 1.0, text="share of the extra static friction that slip has taken", known=True)

    @staticmethod
    def start_deflection(push, velocity, speed, static, coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion."""
        sliding = coulomb if velocity > 0.0 else -coulomb
        resting = max(-static, min(static, push))
        return compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_stiff_deflection(push, velocity, speed, static, coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion."""
        sliding = coulomb if velocity > 0.0 else -coulomb
        resting = max(-static, min(static, push))
        return 0.2 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_soft_deflection(push, velocity, speed, static, coulomb, compliance):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion."""
        sliding = coulomb if velocity > 0.0 else -coulomb
        resting = max(-static, min(static, push))
        return 1.8 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_weakness(speed):
        """Start weak in motion and healed at rest."""
        return 1.0 if speed > 0.0 else 0.0

    @staticmethod
    def d_deflection(deflection, weakness, velocity, static, coulomb, compliance):
        """Rate of the deflection."""
        level = static - (static - coulomb) * weakness
        share = deflection / (compliance * level)
        return velocity * (1.0 - (share * share if velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_stiff_deflection(stiff_deflection, weakness, velocity, static, coulomb, compliance):
        """Rate of the deflection."""
        level = static - (static - coulomb) * weakness
        share = stiff_deflection / (0.2 * compliance * level)
        return velocity * (1.0 - (share * share if velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_soft_deflection(soft_deflection, weakness, velocity, static, coulomb, compliance):
        """Rate of the deflection."""
        level = static - (static - coulomb) * weakness
        share = soft_deflection / (1.8 * compliance * level)
        return velocity * (1.0 - (share * share if velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_weakness(
        deflection,
        stiff_deflection,
        soft_deflection,
        weakness,
        speed,
        static,
        coulomb,
        mass,
        compliance,
        fall_velocity,
        lateness,
    ):
        """Rate of the weakness."""
        level = static - (static - coulomb) * weakness
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        slip = speed * min(abs(force) / level, 1.0) ** lateness
        return (slip * slip / (slip * slip + fall_velocity * fall_velocity) - weakness) / (2.0 * pi * sqrt(mass * compliance))

    @staticmethod
    def locks(locks):
        """0: the bristles hold the contact, not the rigid lock."""
        return 0.0 * locks

    @staticmethod
    def friction(
        friction,
        deflection,
        stiff_deflection,
        soft_deflection,
        weakness,
        velocity,
        static,
        coulomb,
        viscous,
        mass,
        compliance,
    ):
        """Friction of bristles and viscous film."""
        level = static - (static - coulomb) * weakness
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        share = force / level
        elastic = velocity * (1.0 - (min(share * share, 1.0) if velocity * share > 0.0 else 0.0))
        damping = 2.0 * sqrt(mass / compliance) * (1.0 - weakness)
        return force + damping * elastic + viscous * velocity
