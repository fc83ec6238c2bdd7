"""Dry friction of the joint: elastic-plastic asperities whose strength weakens with slip and heals at rest.

Three other contacts can take their place, so that no answer hangs on one law: LuGre's bristles, a force smooth in speed,
and a sharp sign.
"""

import math

import numpy as np
from numba import njit

from truth.compiled import within
from truth.pump_joint.plant import Plant

# Four asperity groups of equal strength that yield at growing travel (relative to `bristle_travel`).
YIELD_TRAVEL = np.array([0.25, 0.5, 1.0, 1.5])
HEALING_TIME = 3e-3
SMOOTH_SPEED = 0.1e-3
BRISTLE_DAMPING_SPEED = 0.5e-3
AGEING_SLIP = 20e-6
AGEING_START = 0.1


@njit
def asperity_step(stretch: np.ndarray, slip: float, upper: float, lower: float, stiffness: np.ndarray) -> tuple[float, bool]:
    """Move the asperities by `slip` (m); return their force (N) and whether all of them slide.

    Parallel Jenkins elements (spring and slider), returned to the yield surface after each trial step: Iwan 1966,
    doi:10.1115/1.3625199; return mapping as in Simo and Hughes, Computational Inelasticity, ch. 1.
    They stick truly and give presliding travel with hysteresis; the published law is the limit of no travel.
    """
    force = 0.0
    yielded = 0
    count = stretch.shape[0]
    for group in range(count):
        trial = stretch[group] + slip
        top = upper / count / stiffness[group]
        bottom = -lower / count / stiffness[group]
        if trial >= top:
            trial = top
            yielded += 1
        elif trial <= bottom:
            trial = bottom
            yielded -= 1
        stretch[group] = trial
        force += stiffness[group] * trial
    return force, abs(yielded) == count


@within
def bristle_step(bend: float, speed: float, strength: float, stiffness: float, step: float) -> float:
    """Return the bend of the bristles (m) after a step: z' = v - k |v| z / F (Canudas de Wit et al. 1995).

    doi:10.1109/9.376053; implicit in the bend. Their friction falls with any motion, and their rest creeps.
    """
    return (bend + step * speed) / (1 + step * stiffness * abs(speed) / strength)


@within
def sharp_speed(
    speed: float, push: float, upper: float, lower: float, viscous: float, mass: float, step: float
) -> tuple[float, float]:
    """Return the speed after a step and the friction F sign(v) in it, which holds exactly at rest.

    Implicit in the friction's impulse: Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics.
    """
    share = 1 + step * viscous / mass
    free = (speed + step / mass * push) / share
    impulse = min(max(free, -step / mass * lower / share), step / mass * upper / share)
    return free - impulse, impulse * share * mass / step


@njit
def contact_step(contact: float, age: float, slip_speed: float, plant: Plant, step: float) -> tuple[float, float]:
    """Advance the state of the contact: 1 healed, 0 weakened, and its age (s).

    c' = [(1 - c) - (v/v_w)^2 c]/tau, so that sliding steadily c = 1/(1 + (v/v_w)^2), the curve of Hess and Soom 1990
    (doi:10.1115/1.2920239); in the other form c = exp(-(v/v_w)^2).
    Age: psi' = 1 - |v| psi/D, the ageing law of Dieterich 1979 (doi:10.1029/JB084iB05p02161).
    """
    ratio = slip_speed / plant.weakening_speed
    rate = step / HEALING_TIME
    weakening = ratio * ratio
    if plant.weakening_form != 0.0:
        weakening = math.exp(min(weakening, 20.0)) - 1
    contact = (contact + rate) / (1 + rate * (1 + weakening))
    age = (age + step) / (1 + step * slip_speed / AGEING_SLIP)
    return contact, age


@within
def surface_level(angle: float, worked: float, plant: Plant) -> float:
    """Return the factor on all dry friction at an arm angle (rad) after `worked` joules of friction.

    A misaligned rod presses its bushing in step with the pulley: a fundamental and a weaker second harmonic; in the
    other form a burr makes one broad bump.
    Warming: the shaft and bushing approach a new level as the friction work fills their heat capacity.
    """
    level = 1.0
    if plant.angle_amplitude != 0.0 and plant.angle_form != 0.0:
        distance = (angle - 0.15 * plant.angle_phase) / 0.2
        level += 2 * plant.angle_amplitude * math.exp(-0.5 * distance * distance)
    elif plant.angle_amplitude != 0.0:
        harmonic = math.sin(angle + plant.angle_phase) + 0.25 * math.sin(2 * angle + 1.7 * plant.angle_phase)
        level += plant.angle_amplitude * harmonic
    if plant.warming_share != 0.0:
        share = 1 - math.exp(-worked / plant.warming_energy)
        if plant.warming_form != 0.0:
            # wear goes on as long as work is done: as much after two thirds of that energy
            share = 0.75 * worked / plant.warming_energy
        level += plant.warming_share * share
    return level


@within
def added_force(angle: float, pressure_sum: float, plant: Plant) -> float:
    """Return what adds to the dry friction of either direction (N).

    Lip seals are pressed on by the line pressure: F = c (p1 + p2 - p_ref) (Mueller and Nau, Fluid Sealing, 1998).
    Detent: a bump of 3 deg width at one angle.
    """
    extra = plant.seal_coefficient * (pressure_sum - plant.seal_reference_pressure)
    if plant.seal_form != 0.0:
        # a lip that flattens: the contact grows with the square root of the pressure
        extra *= 2 / (1 + math.sqrt(pressure_sum / plant.seal_reference_pressure))
    if plant.detent_force != 0.0:
        distance = (angle - plant.detent_angle) / math.radians(3.0)
        extra += plant.detent_force * math.exp(-0.5 * distance * distance)
    return extra


@within
def dry_strength(
    coulomb: float, static: float, contact: float, age: float, level: float, extra: float, relief: float, plant: Plant
) -> float:
    """Return the strength of the contact in one direction (N): from static (healed) to Coulomb (weakened).

    Dither takes a share of static friction, below Coulomb friction when it is large: with slip it then rises to it, as
    friction averaged over a vibration does (Thomsen 1999, doi:10.1006/jsvi.1999.2407).
    """
    excess = static * (1 - relief) - coulomb
    if plant.ageing_per_decade != 0.0:
        aged = math.log10(1 + age / AGEING_START)
        if plant.ageing_form != 0.0:
            # a film that is squeezed out is gone after some time
            aged = 2 * (1 - math.exp(-age / 4))
        excess += plant.ageing_per_decade * static * aged
    return max(level * (coulomb + excess * contact) + extra, 0.05 * coulomb)
