"""The moving parts of the joint: sliders with pistons, and the arm behind the string."""

import math

import numpy as np

from truth.compiled import within
from truth.contact import smooth_speed
from truth.pump_joint.arm import arm_load
from truth.pump_joint.friction import (
    BRISTLE_DAMPING_SPEED,
    SMOOTH_SPEED,
    YIELD_TRAVEL,
    added_force,
    asperity_step,
    bristle_step,
    contact_step,
    dry_strength,
    sharp_speed,
    surface_level,
)
from truth.pump_joint.hydraulics import JOINT_PRESSURE
from truth.pump_joint.plant import JOINT_AREA, PULLEY_RADIUS, Plant

# body: slider travel and speed, arm travel and speed (m, m/s at the pitch line), contact, its age, friction work
BODY_ROWS = 7
PROFILE_STEP = 0.1e-3
MICRO_DAMPING = 0.3


@within
def asperity_stiffness(plant: Plant) -> np.ndarray:
    """Return the stiffness (N/m) of each asperity group of sliders and pulley, shape (2, 4), then their sums, (2, 5).

    Chosen so that the whole contact yields over `bristle_travel`; without an elastic string the sliders have it all.
    """
    mean = 0.5 * (plant.static_positive + plant.static_negative)
    count = YIELD_TRAVEL.shape[0]
    stiffness = np.zeros((2, count + 1))
    pulley = plant.string_friction_share if plant.string_stiffness > 0.0 else 0.0
    for group in range(count):
        whole = mean / count / (plant.bristle_travel * YIELD_TRAVEL[group])
        stiffness[0, group] = (1 - pulley) * whole
        stiffness[1, group] = pulley * whole
        # numba takes seconds to compile a sum along an axis
        stiffness[0, count] += stiffness[0, group]
        stiffness[1, count] += stiffness[1, group]
    return stiffness


@within
def travel_fluctuation(profile: np.ndarray, travel: float) -> float:
    """Return this test's friction fluctuation at a travel (m), interpolated on its 0.1 mm grid."""
    place = travel / PROFILE_STEP + 0.5 * (profile.shape[0] - 1)
    place = min(max(place, 0.0), profile.shape[0] - 1.001)
    index = int(place)
    share = place - index
    return (1 - share) * profile[index] + share * profile[index + 1]


@within
def joint_step(
    body: np.ndarray,
    stretch: np.ndarray,
    bristles: np.ndarray,
    hydraulic: np.ndarray,
    profile: np.ndarray,
    directions: np.ndarray,
    relief: float,
    time: float,
    plant: Plant,
    step: float,
) -> None:
    """Advance sliders and arm by Newton's law; one rigid body unless the string is elastic.

    The string is a stiff spring with 5 % of critical damping that carries the arm's inertia, its loads and the pulley's
    share of the friction.
    """
    travel, speed, arm_travel, arm_speed = body[0], body[1], body[2], body[3]
    angle = arm_travel / PULLEY_RADIUS
    level = surface_level(angle, body[6], plant) + travel_fluctuation(profile, travel)
    pressure_sum = max(hydraulic[JOINT_PRESSURE, 0], 0.0) + max(hydraulic[JOINT_PRESSURE, 1], 0.0)
    extra = added_force(angle, pressure_sum, plant)
    upper = dry_strength(
        plant.coulomb_positive, plant.static_positive, body[4], body[5], level + directions[0], extra, relief, plant
    )
    lower = dry_strength(
        plant.coulomb_negative, plant.static_negative, body[4], body[5], level + directions[1], extra, relief, plant
    )
    drive = JOINT_AREA * (hydraulic[JOINT_PRESSURE, 0] - hydraulic[JOINT_PRESSURE, 1])
    viscous = plant.viscous_positive if speed > 0 else plant.viscous_negative
    load = arm_load(arm_travel, arm_speed, time, plant)
    elastic = plant.string_stiffness > 0.0
    share = 1 - plant.string_friction_share if elastic else 1.0
    mass = plant.slider_mass if elastic else plant.slider_mass + plant.arm_mass + plant.load_mass
    damping = viscous
    micro = 2 * MICRO_DAMPING * math.sqrt(bristles[0, -1] * mass)
    if plant.contact_law == 1.0:
        stretch[0, 0] = bristle_step(stretch[0, 0], speed, share * (upper if speed > 0 else lower), bristles[0, -1], step)
        friction, sliding = bristles[0, -1] * stretch[0, 0], True
        damping += micro * math.exp(-abs(speed) / BRISTLE_DAMPING_SPEED)
    elif plant.contact_law >= 2.0:
        friction, sliding = 0.0, True
    else:
        friction, sliding = asperity_step(stretch[0], speed * step, share * upper, share * lower, bristles[0])
        if not sliding:
            damping += micro
    force = drive - friction
    if elastic:
        arm_mass = plant.arm_mass + plant.load_mass
        loss = 0.1 * math.sqrt(plant.string_stiffness * arm_mass)
        stretched = travel - arm_travel
        if plant.string_hardening > 0.0:
            stretched *= 0.5 + (stretched / plant.string_hardening) ** 2
        tension = plant.string_stiffness * stretched + loss * (speed - arm_speed)
        force -= tension
        rest = 1 - share
        arm_friction, arm_sliding = asperity_step(stretch[1], arm_speed * step, rest * upper, rest * lower, bristles[1])
        arm_damping = 0.0
        if not arm_sliding:
            arm_damping = 2 * MICRO_DAMPING * math.sqrt(bristles[1, -1] * arm_mass)
        pull = tension + load - arm_friction
        arm_speed = (arm_speed + step / arm_mass * pull) / (1 + step * arm_damping / arm_mass)
        arm_travel += step * arm_speed
    else:
        force += load
    if plant.contact_law == 2.0:
        speed = smooth_speed(speed, force, share * upper, share * lower, damping, mass, SMOOTH_SPEED, step)
        friction = share * (upper if speed > 0 else lower) * math.tanh(speed / SMOOTH_SPEED)
    elif plant.contact_law == 3.0:
        speed, friction = sharp_speed(speed, force, share * upper, share * lower, damping, mass, step)
    else:
        speed = (speed + step / mass * force) / (1 + step * damping / mass)
    travel += step * speed
    slip_speed = abs(speed) if sliding else 0.0
    body[4], body[5] = contact_step(body[4], body[5], slip_speed, plant, step)
    body[6] += abs(friction * speed) * step
    body[0], body[1] = travel, speed
    body[2], body[3] = (arm_travel, arm_speed) if elastic else (travel, speed)
