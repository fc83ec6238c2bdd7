"""Loads on the arm and the string between sliders and pulley."""

import math

from numba import njit

from truth.compiled import within
from truth.pump_joint.plant import PULLEY_RADIUS, Plant


@within
def arm_load(travel: float, speed: float, time: float, plant: Plant) -> float:
    """Return the sum of outside forces at the pulley's pitch line (N, positive in positive direction).

    Weight: -(m g r/r_p) sin(angle + phase). Stray spring: -k (y - y_0), or its cube. Soft stop: a damped rubber spring beyond its
    angle. Vibration: A sin(2 pi f t + phase). Statics of the arm; pitch radius r_p = 3.41 mm.
    """
    angle = travel / PULLEY_RADIUS
    force = 0.0
    if plant.weight_force != 0.0:
        force -= plant.weight_force * math.sin(angle + plant.weight_phase)
    if plant.spring_stiffness != 0.0:
        distance = travel - plant.spring_centre
        if plant.spring_form != 0.0:
            # as strong as the linear one at half a radian
            distance *= (distance / (0.5 * PULLEY_RADIUS)) ** 2
        force -= plant.spring_stiffness * distance
    if plant.stop_stiffness != 0.0:
        depth = travel - plant.stop_angle * PULLEY_RADIUS
        if depth > 0.0:
            force -= max(plant.stop_stiffness * depth + 5.0 * speed, 0.0)
    if plant.vibration_force != 0.0:
        turn = 2 * math.pi * plant.vibration_frequency * time
        force += plant.vibration_force * math.sin(turn + plant.vibration_phase)
    return force


@njit
def disc_reading(angle: float, plant: Plant) -> float:
    """Return the angle (rad) that an eccentric encoder disc shows to a single reading head.

    Exact geometry: the head sees the direction of the disc's point from the disc's own centre, which circles the axis
    at `disc_eccentricity` (share of the track radius). Source: triangle of axis, centre and head.
    """
    if plant.disc_eccentricity == 0.0:
        return angle
    inner = angle + plant.disc_phase
    share = plant.disc_eccentricity
    error = math.atan2(share * math.sin(inner), 1.0 + share * math.cos(inner))
    zero = math.atan2(share * math.sin(plant.disc_phase), 1.0 + share * math.cos(plant.disc_phase))
    if plant.disc_form != 0.0:
        # an oval disc adds an error that comes twice in a turn
        error += 0.4 * share * math.sin(2 * inner)
        zero += 0.4 * share * math.sin(2 * plant.disc_phase)
    return angle + error - zero
