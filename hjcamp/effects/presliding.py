"""Bristle friction before breakaway."""

from __future__ import annotations

from math import exp, sqrt

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class Presliding(Effect):
    r"""Before breakaway the seals give way like springs; the friction follows their deflection (LuGre).

    .. math:: \dot q = v - \frac{\sigma_0 |v|}{g(v)}\,q, \quad g(v) = F_c + (F_s - F_c)\,e^{-(v/v_s)^2}, \quad
              f = \sigma_0 q + \sigma_1 e^{-(v/v_s)^2}\,\dot q + C_v v

    with sigma_0 = 1 / c and sigma_1 = 2 sqrt(sigma_0 m). Breaks away at F_s, slides at F_c + C_v v. At rest the bristles
    carry the push: from there a test starts.
    Seen as: motion of some hundredths of a millimetre below breakaway, and its recovery when the force is taken off.
    Not for: the fall of friction at speeds far above v_s (see stribeck_friction).
    Source: Canudas de Wit et al. (1995), IEEE Trans. Autom. Control 40(3), 419-425, doi:10.1109/9.376053;
    damping that fades with speed: Olsson et al. (1998), Eur. J. Control 4(3), doi:10.1016/S0947-3580(98)70113-X.
    """

    subsystem = "joint"
    compliance = Parameter("m/N", 4e-6, (2e-7, 2e-4), "log-uniform", "deflection for each newton", shape=True, off=0.0)
    fall_velocity = Parameter(
        "m/s",
        2e-3,
        (2e-4, 5e-2),
        "log-uniform",
        "speed at which the extra static friction has fallen to 37 %",
        shape=True,
        off=0.0,
    )
    deflection = State("m", 2e-8, 1e-5, text="deflection of the bristles", known=True)

    @staticmethod
    def start_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance, fall_velocity):
        """Start with bristles that carry the push at rest, and as in steady sliding in motion, m."""
        level = friction_coulomb + (friction_static - friction_coulomb) * exp(-((speed / fall_velocity) ** 2))
        sliding = level if slider_velocity > 0.0 else -level
        resting = max(-friction_static, min(friction_static, push))
        return compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def d_deflection(deflection, slider_velocity, speed, friction_static, friction_coulomb, compliance, fall_velocity):
        """Rate of the deflection, m/s."""
        fall = exp(-((speed / fall_velocity) ** 2))
        level = friction_coulomb + (friction_static - friction_coulomb) * fall
        return slider_velocity - speed * deflection / (compliance * level)

    @staticmethod
    def friction_locks(friction_locks):
        """0: the bristles hold the slider, not the rigid lock."""
        return 0.0 * friction_locks

    @staticmethod
    def friction(
        friction,
        deflection,
        slider_velocity,
        speed,
        friction_static,
        friction_coulomb,
        friction_viscous,
        moving_mass,
        compliance,
        fall_velocity,
    ):
        """Friction of bristles and viscous film, N."""
        fall = exp(-((speed / fall_velocity) ** 2))
        level = friction_coulomb + (friction_static - friction_coulomb) * fall
        sliding = slider_velocity - speed * deflection / (compliance * level)
        return (
            deflection / compliance
            + 2.0 * sqrt(moving_mass / compliance) * fall * sliding
            + friction_viscous * slider_velocity
        )
