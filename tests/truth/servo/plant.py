"""A motor that swings a pendulum, alone or over a rope with a second joint: one test under a given torque, no loop."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from truth.axis.plant import PROFILE_POINTS, RING, Axis, drive_volt, encoder, outside_force, strength
from truth.compiled import fingerprint_of, within
from truth.contact import contact_step

PERIOD = 2e-3
SUBSTEPS = 20
STEP = PERIOD / SUBSTEPS
RANGE = math.pi  # the friction profile covers an angle of this size to each side


class Swing(NamedTuple):
    """What swings: weight times radius (N m), and, where the rope has a stiffness (N m/rad), a second joint that bears it.

    Hidden: `lean` (rad) and its rate, by which the base is not level; a weight that slides out with speed; a rope that
    stiffens, goes slack or creeps; a stop at an angle, after Hunt and Crossley or as a rubber that stiffens.
    """

    weight: float = 1.0
    rope: float = 0.0
    rope_damping: float = 0.0
    lean: float = 0.0
    lean_rate: float = 0.0
    sliding: float = 0.0
    hardening: float = 0.0
    slack: float = 0.0
    stop: float = 0.0
    stop_angle: float = 0.6
    stop_form: float = 0.0


@within
def swing_torque(angle: float, speed: float, time: float, swing: Swing) -> float:
    """Return the torque of the weight and of a stop on the joint that bears them (N m)."""
    moment = swing.weight * (1 + swing.sliding * speed * speed)
    torque = -moment * math.sin(angle - swing.lean - swing.lean_rate * time)
    depth = angle - swing.stop_angle
    if swing.stop != 0.0 and depth > 0.0:
        if swing.stop_form == 0.0:
            torque -= max(swing.stop * depth * (1 + 0.3 * speed), 0.0)
        else:
            torque -= swing.stop * depth * math.sqrt(depth / 0.1)
    return torque


@within
def rope_torque(stretch: float, rate: float, swing: Swing) -> float:
    """Return what the rope passes on (N m): k (s + h s^3) + d s'; below `slack` (rad) to each side it hangs loose."""
    if abs(stretch) <= swing.slack:
        return 0.0
    taut = stretch - math.copysign(swing.slack, stretch)
    return swing.rope * taut * (1 + swing.hardening * taut * taut) + swing.rope_damping * rate


@within
def simulate(
    motor: Axis, arm: Axis, swing: Swing, torque: np.ndarray, profile: np.ndarray, wander: np.ndarray, counted: float
) -> np.ndarray:
    """Run one test; return rows (n, 6): motor angle and arm angle as read (rad), then true angles and speeds of both.

    `torque` (n,) in N m at 2 ms, held; `motor` and `arm` describe the joints (their mass is the inertia, their units are
    rad and N m). Without a rope the arm is the motor. `profile` (2, 201) and `wander` (2, n) are shares of friction.
    """
    rows = np.zeros((torque.shape[0], 6))
    stretch = np.zeros((2, 6))
    places, speeds, travelled = np.zeros(2), np.zeros(2), np.zeros(2)
    roped = swing.rope > 0.0
    current, seen, carried, bend = 0.0, 0.0, 0.0, 0.0
    filtered = np.zeros(3)
    asked_ring, head_ring = np.zeros(RING), np.zeros(RING)
    delay_ticks = round(motor.delay / STEP) if motor.delay_form == 0.0 else 0
    sensor_ticks = round(motor.sensor_lag / STEP)
    tick = 0
    for index in range(torque.shape[0]):
        time = index * PERIOD
        rows[index, 0] = math.floor(encoder(seen, time, motor) / motor.count + counted) * motor.count
        rows[index, 1] = math.floor(encoder(places[1], time, arm) / arm.count + counted) * arm.count
        rows[index, 2], rows[index, 3], rows[index, 4], rows[index, 5] = places[0], places[1], speeds[0], speeds[1]
        for _ in range(SUBSTEPS):
            asked_ring[tick % RING] = torque[index]
            asked = asked_ring[(tick - delay_ticks) % RING]
            if motor.delay_form == 1.0:
                filtered[0] += STEP / (0.5 * motor.delay + STEP) * (torque[index] - filtered[0])
                filtered[1] += STEP / (0.5 * motor.delay + STEP) * (filtered[0] - filtered[1])
                asked = filtered[1]
            current += STEP / (motor.current_lag + STEP) * (asked - current)
            tick += 1
            time += STEP
            passed = rope_torque(places[0] - places[1], speeds[0] - speeds[1], swing) if roped else 0.0
            for joint in range(2):
                if joint == 1 and not roped:
                    places[1], speeds[1] = places[0], speeds[0]
                    break
                body = motor if joint == 0 else arm
                place, speed = places[joint], speeds[joint]
                force = outside_force(place, speed, time, body)
                if joint == 0:
                    force += motor.gain * drive_volt(current, speed, time, motor) - passed
                else:
                    force += passed
                if joint == 1 or not roped:
                    force += swing_torque(place, speed, time, swing)
                spot = (place / RANGE + 1) * 0.5 * (PROFILE_POINTS - 1)
                level = 1 + wander[joint, index] + profile[joint, int(min(max(spot, 0.0), PROFILE_POINTS - 1.0))]
                upper, lower = strength(place, speed, time, travelled[joint], level, body)
                viscous = body.viscous_positive if speed > 0 else body.viscous_negative
                inertia = body.mass + (body.placed_mass if time >= body.placed_at else 0.0)
                speed, _ = contact_step(
                    int(body.law), speed, force, inertia, upper, lower, viscous, body.grain, stretch[joint], STEP
                )
                speeds[joint] = speed
                places[joint] += STEP * speed
                travelled[joint] += STEP * abs(speed)
            head = places[0]
            if motor.play != 0.0 and motor.play_form == 0.0:
                carried = min(max(carried, head - 0.5 * motor.play), head + 0.5 * motor.play)
                head = carried
            elif motor.play != 0.0:
                bend += STEP * (speeds[0] - abs(speeds[0]) * bend / (0.5 * motor.play))
                head -= bend
            head_ring[tick % RING] = head
            if motor.sensor_form == 1.0:
                seen = head_ring[(tick - sensor_ticks) % RING]
            elif motor.sensor_form == 2.0:
                filtered[2] += STEP / (0.5 * motor.sensor_lag + STEP) * (head - filtered[2])
                seen += STEP / (0.5 * motor.sensor_lag + STEP) * (filtered[2] - seen)
            else:
                seen += STEP / (motor.sensor_lag + STEP) * (head - seen) if motor.sensor_lag > 0.0 else head - seen
    return rows


def _compiled(fingerprint: int) -> Callable[..., Any]:
    @njit(cache=True)
    def cached(motor, arm, swing, torque, profile, wander, counted):
        return simulate(motor, arm, swing, torque, profile, wander, counted), fingerprint

    return cached


_RUN = _compiled(fingerprint_of("servo/plant", "axis/plant", "contact"))


def run(
    motor: Axis, arm: Axis, swing: Swing, torque: np.ndarray, profile: np.ndarray, wander: np.ndarray, counted: float
) -> np.ndarray:
    """Run `simulate`, compiled once for these sources and cached on disk."""
    rows, _ = _RUN(motor, arm, swing, torque, profile, wander, counted)
    return rows
