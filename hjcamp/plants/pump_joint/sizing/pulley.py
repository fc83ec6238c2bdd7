"""The slider-pulley joint, its string and its drive: transmission, torque, resolution, envelope (thesis 3.6 to 3.8)."""

from __future__ import annotations

import math


def turn_angle(turns: float) -> float:
    """Return the contact angle of the string in rad: 2 pi x turns. Source: thesis 3.6.3."""
    return 2.0 * math.pi * turns


def tension_ratio(turns: float, friction_coefficient: float) -> float:
    """Return T2/T1 = exp(mu beta) at the onset of slip (belt friction, string without stiffness). Source: thesis 3.6.1."""
    return math.exp(friction_coefficient * turn_angle(turns))


def largest_torque(tension: float, turns: float, friction_coefficient: float, pulley_radius: float) -> float:
    """Return the torque in N*m at which the string slips on the pulley.

    .. math:: M = T_1 (e^{\\mu \\beta} - 1) r_p

    with T_1 the tension on the resisting side. SI units. Source: thesis 3.6.1, 3.6.2.
    """
    return tension * math.expm1(friction_coefficient * turn_angle(turns)) * pulley_radius


def least_tension(torque: float, turns: float, friction_coefficient: float, pulley_radius: float) -> float:
    """Return the tension T_1 in N without which ``torque`` slips the string. SI units. Source: thesis 3.6.3."""
    return torque / (math.expm1(friction_coefficient * turn_angle(turns)) * pulley_radius)


def arm_per_travel(pitch_diameter: float) -> float:
    """Return what the arm turns for one metre of the sliders, rad/m: 2 / d. Source: thesis 3.6.4."""
    return 2.0 / pitch_diameter


def arm_per_rack_travel(arm_angle: float, travel: float) -> float:
    """Return rad/m of a transmission known by one angle and its travel, as the earlier rack (thesis 2.4, 6.3)."""
    return arm_angle / travel


def arm_per_motor(pitch_diameter: float, pump_bore: float, joint_bore: float, lead: float) -> float:
    r"""Return what the arm turns for one turn of the pump motor (rad/rad), lines rigid.

    .. math:: \frac{\theta_a}{\theta_m} = \frac{2}{d_p}\,\frac{A_1}{A_2}\,\frac{h}{2\pi}

    with the lead h in m per turn. Source: thesis 4.6.1.
    """
    return arm_per_travel(pitch_diameter) * (pump_bore / joint_bore) ** 2 * lead / (2.0 * math.pi)


def motor_per_arm(pitch_diameter: float, pump_bore: float, joint_bore: float, lead: float) -> float:
    """Return how often the motor turns for one turn of the arm, the 8.5 of thesis 4.6.1; see `arm_per_motor`."""
    return 1.0 / arm_per_motor(pitch_diameter, pump_bore, joint_bore, lead)


def pump_volume(pump_bore: float, lead: float) -> float:
    """Return the water moved for one radian of the pump motor, m^3/rad: pi d^2/4 x h/(2 pi). Source: thesis 3.8.1, 3.8.2."""
    return pump_bore**2 * lead / 8.0


def encoder_step(counts: float) -> float:
    """Return the angle of one count of an encoder, rad: 2 pi / counts. Source: thesis 3.7."""
    return 2.0 * math.pi / counts


def envelope(width: float, height: float) -> float:
    """Return the diameter in m of the smallest tube around a rectangle. Source: thesis 3.6 (sizes), geometry ours."""
    return math.hypot(width, height)
