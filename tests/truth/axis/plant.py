"""A carriage on a guide in other people's position loop: one test, by fixed steps, shares no code with `hjcamp`."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from truth.compiled import fingerprint_of, within
from truth.contact import contact_step, falling

SAMPLE = 1e-3
SUBSTEPS = 10
STEP = SAMPLE / SUBSTEPS
RING = 1024
LIMIT_VOLT = 10.0
PROFILE_POINTS = 201


class Axis(NamedTuple):
    """One axis, its loop, and what hides in it; SI. A hidden quantity that is 0 is not there."""

    mass: float = 95.0
    gain: float = 35.0
    coulomb_positive: float = 20.0
    coulomb_negative: float = 20.0
    viscous_positive: float = 200.0
    viscous_negative: float = 200.0
    law: float = 0.0
    grain: float = 3e-6
    # the loop: position gain (1/s), speed gain (V s/m), integral (V/m), difference filter, lag of the current, counts
    kp: float = 12.0
    kv: float = 160.0
    ki: float = 1500.0
    difference_time: float = 1e-3
    current_lag: float = 4e-4
    late_samples: float = 0.0
    count: float = 1e-6
    converter_volt: float = 1e-3
    # friction that falls with speed, changes with place, differs between directions, warms up
    excess: float = 0.0
    fall_speed: float = 5e-3
    fall_form: float = 0.0
    place_share: float = 0.0
    place_length: float = 0.1
    place_phase: float = 0.0
    place_form: float = 0.0
    late_asymmetry: float = 0.0
    asymmetry_speed: float = 0.02
    warming: float = 0.0
    warming_time: float = 8.0
    warming_travel: float = 1.0
    warming_form: float = 0.0
    # forces from outside
    steady_force: float = 0.0
    cable_length: float = 0.0
    spring: float = 0.0
    spring_centre: float = 0.0
    spring_length: float = 0.1
    spring_form: float = 0.0
    drag: float = 0.0
    drag_power: float = 2.0
    ripple: float = 0.0
    ripple_length: float = 0.02
    ripple_phase: float = 0.0
    ripple_speed: float = 0.0
    vibration: float = 0.0
    vibration_frequency: float = 7.0
    # the drive
    delay: float = 0.0
    delay_form: float = 0.0
    dead_band: float = 0.0
    dead_form: float = 0.0
    saturation: float = 0.0
    saturation_form: float = 0.0
    gain_loss: float = 0.0
    gain_time: float = 8.0
    speed_loss: float = 0.0
    # the encoder
    sensor_lag: float = 0.0
    sensor_form: float = 0.0
    scale_error: float = 0.0
    scale_drift: float = 0.0
    drift: float = 0.0
    drift_time: float = 0.0
    play: float = 0.0
    play_form: float = 0.0
    pitch_error: float = 0.0
    # mass that is put on at a time, or that swings behind the carriage
    placed_mass: float = 0.0
    placed_at: float = 0.0
    swinging_mass: float = 0.0
    swing_frequency: float = 8.0


@within
def strength(place: float, speed: float, time: float, travelled: float, level: float, axis: Axis) -> tuple[float, float]:
    """Return the strength of the guide's dry friction against motion in the positive and negative direction (N)."""
    factor = level
    if axis.place_share != 0.0:
        if axis.place_form == 0.0:
            factor += axis.place_share * math.sin(2 * math.pi * place / axis.place_length + axis.place_phase)
        else:
            distance = (place - axis.place_phase) / axis.place_length
            factor += axis.place_share * math.exp(-0.5 * distance * distance)
    if axis.warming != 0.0:
        clock = time / axis.warming_time if axis.warming_form == 0.0 else travelled / axis.warming_travel
        factor += axis.warming * (1 - math.exp(-clock)) if axis.warming_form == 0.0 else axis.warming * clock**0.5
    extra = falling(axis.excess, axis.fall_speed, speed, axis.fall_form)
    tilt = axis.late_asymmetry * abs(speed) / (abs(speed) + axis.asymmetry_speed)
    upper = factor * (axis.coulomb_positive * (1 + tilt) + extra)
    lower = factor * (axis.coulomb_negative * (1 - tilt) + extra)
    return max(upper, 1e-3 * axis.coulomb_positive), max(lower, 1e-3 * axis.coulomb_negative)


@within
def outside_force(place: float, speed: float, time: float, axis: Axis) -> float:
    """Return the force on the carriage from outside (N).

    A steady force, whose cable chain hangs as a catenary where it has a length; a spring that is linear, cubic
    (F/k = d^3/l^2) or softening (F/k = l tanh(d/l)); drag -c |v|^p sign v; a ripple sin(2 pi x/l) (1 + |v|/v_0).
    """
    force = axis.steady_force
    if axis.cable_length != 0.0:
        force *= math.cosh(place / axis.cable_length)
    if axis.spring != 0.0:
        distance = place - axis.spring_centre
        if axis.spring_form == 1.0:
            distance *= (distance / axis.spring_length) ** 2
        elif axis.spring_form == 2.0:
            distance = axis.spring_length * math.tanh(distance / axis.spring_length)
        force -= axis.spring * distance
    if axis.drag != 0.0:
        force -= math.copysign(axis.drag * abs(speed) ** axis.drag_power, speed)
    if axis.ripple != 0.0:
        growth = 1 + abs(speed) / axis.ripple_speed if axis.ripple_speed > 0.0 else 1.0
        force += axis.ripple * math.sin(2 * math.pi * place / axis.ripple_length + axis.ripple_phase) * growth
    if axis.vibration != 0.0:
        force += axis.vibration * math.sin(2 * math.pi * axis.vibration_frequency * time)
    return force


@within
def drive_volt(volt: float, speed: float, time: float, axis: Axis) -> float:
    """Return the voltage that still makes force: dead band, saturation, loss by heat and by speed.

    Soft forms: u - b tanh(u/b), and u / (1 + |u/s|^3)^(1/3), which no hard corner shows.
    """
    if axis.dead_band != 0.0:
        if axis.dead_form == 0.0:
            volt = math.copysign(max(abs(volt) - axis.dead_band, 0.0), volt)
        else:
            volt -= axis.dead_band * math.tanh(volt / axis.dead_band)
    if axis.saturation != 0.0:
        if axis.saturation_form == 0.0:
            volt = min(max(volt, -axis.saturation), axis.saturation)
        else:
            volt /= (1 + abs(volt / axis.saturation) ** 3) ** (1 / 3)
    volt *= 1 - axis.gain_loss * (1 - math.exp(-time / axis.gain_time))
    return volt * max(1 - axis.speed_loss * abs(speed), 0.0)


@within
def encoder(place: float, time: float, axis: Axis) -> float:
    """Return what the scale shows at a place and time: scale error (steady and growing), drift, pitch error."""
    shown = place * (1 + axis.scale_error + axis.scale_drift * time)
    if axis.drift != 0.0:
        if axis.drift_time > 0.0:
            shown += axis.drift * axis.drift_time * (1 - math.exp(-time / axis.drift_time))
        else:
            shown += axis.drift * time
    if axis.pitch_error != 0.0:
        shown += axis.pitch_error * math.sin(2 * math.pi * place / axis.ripple_length + axis.ripple_phase)
    return shown


@within
def simulate(
    axis: Axis, reference: np.ndarray, pulses: np.ndarray, profile: np.ndarray, wander: np.ndarray, counted: float
) -> np.ndarray:
    """Run one test; return rows (n, 5): position read (m), voltage (V), reference (m), true position and speed.

    `reference` (m) and `pulses` (V, added to the controller's voltage) at 1 kHz; `profile` is the share of friction
    that varies over the travel of the reference, `wander` over time; `counted` the fraction of a count at the start.
    """
    rows = np.zeros((reference.shape[0], 5))
    law, stretch = int(axis.law), np.zeros(6)
    start = low = high = reference[0]
    for value in reference:
        low, high = min(low, value), max(high, value)
    place, speed, travelled = start, 0.0, 0.0
    behind, behind_speed = start, 0.0
    seen, carried, bend = start, start, 0.0
    shown_before, estimate, integral, current = 0.0, 0.0, 0.0, 0.0
    # two lags of the drive, then one of the reading head
    filtered = np.array([0.0, 0.0, start])
    volts, places = np.zeros(RING), np.full(RING, start)
    waiting = np.zeros(4)
    tick = 0
    delay_ticks = round(axis.delay / STEP) if axis.delay_form == 0.0 else 0
    sensor_ticks = round(axis.sensor_lag / STEP)
    for index in range(reference.shape[0]):
        time = index * SAMPLE
        shown = math.floor(encoder(seen, time, axis) / axis.count + counted) * axis.count
        if index == 0:
            shown_before = shown
        estimate += SAMPLE / (axis.difference_time + SAMPLE) * ((shown - shown_before) / SAMPLE - estimate)
        shown_before = shown
        feed = (reference[index] - reference[index - 1]) / SAMPLE if index > 0 else 0.0
        wrong = feed + axis.kp * (reference[index] - shown) - estimate
        integral = min(max(integral + axis.ki * wrong * SAMPLE, -LIMIT_VOLT), LIMIT_VOLT)
        volt = min(max(axis.kv * wrong + integral + pulses[index], -LIMIT_VOLT), LIMIT_VOLT)
        volt = math.floor(volt / axis.converter_volt + 0.5) * axis.converter_volt
        rows[index, 0], rows[index, 1], rows[index, 2] = shown, volt, reference[index]
        rows[index, 3], rows[index, 4] = place, speed
        for late in range(3, 0, -1):
            waiting[late] = waiting[late - 1]
        waiting[0] = volt
        applied = waiting[int(axis.late_samples)]
        spot = (place - low) / max(high - low, 1e-9) * (PROFILE_POINTS - 1)
        level = 1 + wander[index] + profile[int(min(max(spot, 0.0), PROFILE_POINTS - 1.0))]
        for _ in range(SUBSTEPS):
            volts[tick % RING] = applied
            asked = volts[(tick - delay_ticks) % RING]
            if axis.delay_form == 1.0:
                filtered[0] += STEP / (0.5 * axis.delay + STEP) * (applied - filtered[0])
                filtered[1] += STEP / (0.5 * axis.delay + STEP) * (filtered[0] - filtered[1])
                asked = filtered[1]
            current += STEP / (axis.current_lag + STEP) * (asked - current)
            tick += 1
            moment = time + STEP
            mass = axis.mass + (axis.placed_mass if moment >= axis.placed_at else 0.0)
            force = axis.gain * drive_volt(current, speed, moment, axis) + outside_force(place, speed, moment, axis)
            if axis.swinging_mass > 0.0:
                turn = 2 * math.pi * axis.swing_frequency
                pull = axis.swinging_mass * (turn**2 * (behind - place) + 0.06 * turn * (behind_speed - speed))
                force += pull
                behind_speed -= STEP / axis.swinging_mass * pull
                behind += STEP * behind_speed
            upper, lower = strength(place, speed, moment, travelled, level, axis)
            viscous = axis.viscous_positive if speed > 0 else axis.viscous_negative
            speed, _ = contact_step(law, speed, force, mass, upper, lower, viscous, axis.grain, stretch, STEP)
            place += STEP * speed
            travelled += STEP * abs(speed)
            # the reading head: play, or wind-up that is taken up over the travel; then its lag
            head = place
            if axis.play != 0.0 and axis.play_form == 0.0:
                carried = min(max(carried, place - 0.5 * axis.play), place + 0.5 * axis.play)
                head = carried
            elif axis.play != 0.0:
                bend += STEP * (speed - abs(speed) * bend / (0.5 * axis.play))
                head = place - bend
            places[tick % RING] = head
            if axis.sensor_form == 0.0:
                seen += STEP / (axis.sensor_lag + STEP) * (head - seen) if axis.sensor_lag > 0.0 else head - seen
            elif axis.sensor_form == 1.0:
                seen = places[(tick - sensor_ticks) % RING]
            else:
                filtered[2] += STEP / (0.5 * axis.sensor_lag + STEP) * (head - filtered[2])
                seen += STEP / (0.5 * axis.sensor_lag + STEP) * (filtered[2] - seen)
    return rows


def _compiled(fingerprint: int) -> Callable[..., Any]:
    @njit(cache=True)
    def cached(axis, reference, pulses, profile, wander, counted):
        return simulate(axis, reference, pulses, profile, wander, counted), fingerprint

    return cached


_RUN = _compiled(fingerprint_of("axis/plant", "contact"))


def run(
    axis: Axis, reference: np.ndarray, pulses: np.ndarray, profile: np.ndarray, wander: np.ndarray, counted: float
) -> np.ndarray:
    """Run `simulate`, compiled once for these sources and cached on disk."""
    rows, _ = _RUN(axis, reference, pulses, profile, wander, counted)
    return rows
