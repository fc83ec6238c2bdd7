"""Formulas of chapter 4 that need no measurement: flow in the tubing, compliance, effective mass."""

from __future__ import annotations

import math

GRAVITY = 9.81
ATMOSPHERE = 101325.0


def tubing_speed(piston_speed: float, pump_bore: float, inner_diameter: float) -> float:
    """Return the speed (or, of an acceleration, the acceleration) of the water in the tubing.

    .. math:: v = \\frac{d_1^2}{d_i^2} \\dot x

    SI units. Source: thesis 4.4.1.1 and 4.4.2.1.
    """
    return piston_speed * (pump_bore / inner_diameter) ** 2


def reynolds_number(speed: float, inner_diameter: float, density: float, viscosity: float) -> float:
    """Return Re = rho v d / mu; laminar below about 2000. SI units. Source: thesis 4.4.1.2."""
    return density * speed * inner_diameter / viscosity


def resistance_drop(speed: float, length: float, inner_diameter: float, viscosity: float) -> float:
    """Return the pressure drop of laminar flow in Pa.

    .. math:: \\Delta p = 32\\,\\mu L v / d_i^2

    SI units. Source: thesis 4.4.1.2 (Hagen-Poiseuille).
    """
    return 32.0 * viscosity * length * speed / inner_diameter**2


def inertance_drop(acceleration: float, length: float, density: float) -> float:
    """Return the pressure drop rho L a of accelerating water in Pa. SI units. Source: thesis 4.4.2.1."""
    return density * length * acceleration


def tubing_volume(inner_diameter: float, length: float) -> float:
    """Return the volume inside the tubing in m^3."""
    return math.pi / 4.0 * inner_diameter**2 * length


def tubing_modulus(inner_diameter: float, outer_diameter: float, youngs_modulus: float, poisson_ratio: float) -> float:
    """Return the bulk modulus of the tubing's elasticity in Pa.

    .. math:: \\beta_p = \\frac{(r_o^2 - r_i^2) E}{2[(1-\\nu) r_i^2 + (1+\\nu) r_o^2]}

    SI units; thick wall, open ends. Source: thesis 4.4.3.11.
    """
    inner, outer = (0.5 * inner_diameter) ** 2, (0.5 * outer_diameter) ** 2
    return (outer - inner) * youngs_modulus / (2.0 * ((1 - poisson_ratio) * inner + (1 + poisson_ratio) * outer))


def effective_modulus(water: float, tubing: float, air_fraction: float, absolute_pressure: float) -> float:
    """Return the effective bulk modulus of a line in Pa.

    .. math:: 1/\\beta_e = 1/\\beta_w + S/p + 1/\\beta_p

    with isothermal air, p absolute in Pa. Source: thesis 4.4.3.6 and 4.4.3.14.
    """
    return 1.0 / (1.0 / water + air_fraction / absolute_pressure + 1.0 / tubing)


def air_fraction(effective: float, water: float, tubing: float, absolute_pressure: float) -> float:
    """Return the air content S that explains an effective bulk modulus; negative where tubing and water exceed it.

    SI units, p absolute. Source: thesis 4.4.3.14, solved for S.
    """
    return absolute_pressure * (1.0 / effective - 1.0 / water - 1.0 / tubing)


def compressed_air_modulus(water: float, tubing: float, air_fraction: float, absolute_pressure: float) -> float:
    """Return the effective bulk modulus in Pa where S is the air's share at atmospheric pressure.

    .. math:: 1/\\beta_e = 1/\\beta_w + S p_{atm}/p^2 + 1/\\beta_p

    Isothermal bubbles that have shrunk to S p_atm / p by the time the line is at p; the thesis's own 4.4.3.14 leaves
    that shrinking out. SI units. Source: Merritt (1967), Hydraulic Control Systems, section 2-4.
    """
    return 1.0 / (1.0 / water + air_fraction * ATMOSPHERE / absolute_pressure**2 + 1.0 / tubing)


def effective_mass(inertia: float, pulley_radius: float) -> float:
    """Return the mass at the sliders of a part that turns with the pulley: J / r_p^2, kg. Source: thesis 4.5.2.1."""
    return inertia / pulley_radius**2


def weight_at_sliders(mass: float, radius: float, pulley_radius: float) -> float:
    """Return the largest force at the sliders, N, of a payload on a vertical arm: m g r / r_p. Source: thesis 5.5."""
    return mass * GRAVITY * radius / pulley_radius
