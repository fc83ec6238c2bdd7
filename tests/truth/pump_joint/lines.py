"""The two water lines as volumes: wall elasticity, bubbles, creep, leaks, and the water column between its two ends."""

import math

from numba import njit

from truth.compiled import within
from truth.pump_joint.plant import ATMOSPHERE, VAPOUR, Plant


@njit
def line_pressure(volume: float, stiffness: float, air: float, exponent: float = 1.0) -> float:
    """Return the gauge pressure (Pa) of a line into which `volume` (m^3) was pressed beyond its size at atmosphere.

    The wall takes (P - P_atm)/K and the bubbles, isothermal ideal gas (Boyle), a (1 - P_atm/P) of that volume, with P
    absolute; the positive root of the quadratic. Without bubbles p = K v. Never below the vapour pressure. Bubbles of another
    `exponent` n (1.4: adiabatic) take a (1 - (P_atm/P)^(1/n)); Newton's steps from the isothermal root.
    """
    if air > 0.0:
        middle = stiffness * (air - volume) - ATMOSPHERE
        root = math.sqrt(middle * middle + 4 * stiffness * air * ATMOSPHERE)
        absolute = 0.5 * (root - middle)
        if exponent != 1.0:
            for _ in range(6):
                left = (ATMOSPHERE / absolute) ** (1 / exponent)
                error = (absolute - ATMOSPHERE) / stiffness + air * (1 - left) - volume
                absolute -= error / (1 / stiffness + air * left / (exponent * absolute))
                absolute = max(absolute, ATMOSPHERE + VAPOUR)
        return max(absolute - ATMOSPHERE, VAPOUR)
    return max(stiffness * volume, VAPOUR)


@njit
def line_volume(pressure: float, stiffness: float, air: float, exponent: float = 1.0) -> float:
    """Return the extra volume (m^3) that holds a gauge pressure (Pa): the inverse of `line_pressure`."""
    left = ATMOSPHERE / (ATMOSPHERE + max(pressure, VAPOUR))
    if exponent != 1.0:
        left = left ** (1 / exponent)
    return pressure / stiffness + air * (1 - left)


@njit
def outside_leak(pressure: float, plant: Plant) -> float:
    """Return the loss of a line to the outside (m^3/s).

    Laminar flow through the gap of a fitting whose height h grows with pressure above its opening pressure:
    Q = g p (h/h0)^3, plane Poiseuille flow (White, Viscous Fluid Flow, 3-2). The published leakage test (thesis 4.4.4)
    shows such a threshold.
    """
    if pressure <= 0.0:
        return 0.0
    gap = 1.0 + plant.leak_gap_growth * max(pressure - plant.leak_opening_pressure, 0.0)
    return plant.leak_conductance * pressure * gap * gap * gap


@within
def cross_leak(difference: float, plant: Plant) -> float:
    """Return the flow from line 1 to line 2 (m^3/s): laminar when small, orifice-like when large.

    Q = g dp / sqrt(1 + |dp|/p_t), the smooth blend of Merritt (Hydraulic Control Systems, 1967, ch. 3).
    """
    return plant.cross_conductance * difference / math.sqrt(1 + abs(difference) / plant.cross_turbulent_pressure)


@within
def tube_flow(flow: float, drop: float, resistance: float, stiffness: float, plant: Plant, step: float) -> float:
    """Return the flow (m^3/s) in the tube between the two compliant ends of a line, implicit in its own drop.

    I Q' = p_a - p_b - R Q - k Q|Q|^0.75: unsteady Bernoulli with laminar loss and Blasius' turbulent one (White, Fluid Mechanics,
    6-4 and 6-6), also valid for I = 0. `stiffness` (Pa/m^3) is that of both ends in series; it keeps the step stable.
    """
    inertia = plant.tube_inertance / step
    return (flow * inertia + drop) / (inertia + resistance + plant.tube_turbulence * abs(flow) ** 0.75 + step * stiffness)


@within
def creep_step(extra: float, target: float, time_constant: float, step: float) -> float:
    """Advance one Kelvin-Voigt element of the wall (m^3): w' = (c p/K - w)/tau (Flugge, Viscoelasticity, 1975)."""
    return extra + step * (target - extra) / time_constant
