"""What one stroke of a friction test shows: the force at breakaway, and the force while the arm moves steadily."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.calibrate.constants import Constants
from hjcamp.plants.pump_joint.calibrate.strokes import find_strokes
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
ONSET_COUNTS = 2.5  # arm travel that is motion and not the edge of a count
RISING_S = 0.03
SHORTEST_STICK_S = 0.01
SETTLING_S = 0.04
SHORTEST_PLATEAU_S = 0.03
SAME_SPEED = 0.08
STICKS = "the arm sticks and slips"
STICK_SAMPLES = 11
STICK_SLOPE = 0.6  # of the slope of the force while the arm is held
STICK_SHARE = 0.2  # of a stroke


@dataclass(frozen=True)
class Breakaway:
    """Force at the sliders (N, without sign) at which the arm broke away, and its rise in one sample (N)."""

    test: int
    direction: float
    force: float
    rise: float
    time: float


@dataclass(frozen=True)
class Plateau:
    """Mean force (N) and slider speed (m/s) without sign, while the arm moved steadily; ``scatter`` (N) along it."""

    test: int
    direction: float
    speed: float
    force: float
    scatter: float
    seconds: float


@dataclass(frozen=True)
class Refused:
    """A stroke of no use as a plateau: why, and the slider speed (m/s) that the pump asked for."""

    direction: float
    speed: float
    reason: str


@dataclass(frozen=True)
class Shown:
    """What one test shows, and the strokes that were of no use as plateaus."""

    breakaways: tuple[Breakaway, ...]
    plateaus: tuple[Plateau, ...]
    refused: tuple[Refused, ...]


def read_strokes(log: TestLog, test: int, constants: Constants) -> Shown:
    """Return breakaways and plateaus of one test; ``test`` is its number.

    Force = (p1 - p2) A_2 (thesis 4.4.3.16, 4.5.1); speed from a straight line through the arm angle, which an encoder
    of 0.35 deg does not disturb.
    """
    columns = log.command_phase
    pump = columns["pump_deg"] if "pump_deg" in columns else columns["command_deg"]
    difference = columns["pressure1_mpa"] - columns["pressure2_mpa"]
    force = difference * 1e6 * constants.joint_area
    arm = columns["arm_deg"]
    count = arm_count(arm)
    breakaways, plateaus, refused = [], [], []
    for stroke in find_strokes(pump):
        sign = stroke.direction
        asked = math.radians(abs(stroke.speed)) * constants.pump_lead * constants.pump_area / constants.joint_area
        rows = slice(stroke.start, stroke.stop)
        turned, push, time = sign * arm[rows], sign * force[rows], columns["time_s"][rows]
        onset = _onset(turned, count)
        if onset is None:
            refused.append(Refused(sign, asked, "the arm did not move"))
            continue
        broke = _breakaway(turned[:onset], push[:onset], time[:onset], test, sign)
        if broke is not None:
            breakaways.append(broke)
        begin = onset + round(SETTLING_S / 1e-3)
        expected = math.degrees(asked / constants.pulley_radius)
        reason = _unsteady(turned[begin:], time[begin:], push[begin:], expected, count, broke)
        if reason:
            refused.append(Refused(sign, asked, reason))
            continue
        speed = math.radians(float(np.polyfit(time[begin:], turned[begin:], 1)[0])) * constants.pulley_radius
        steady = push[begin:]
        smooth = np.convolve(steady, np.ones(9) / 9.0, mode="valid")
        plateaus.append(Plateau(test, sign, speed, float(steady.mean()), float(smooth.std()), len(steady) * 1e-3))
    return Shown(tuple(breakaways), tuple(plateaus), tuple(refused))


def arm_count(arm: Array) -> float:
    """Return one count of the arm encoder in deg: the smallest step between its readings."""
    steps = np.diff(np.unique(arm))
    steps = steps[steps > 1e-6]
    return float(np.min(steps)) if len(steps) else 360.0 / 1024


def _onset(turned: Array, count: float) -> int | None:
    # The arm still coasts into the stroke before: it rests at the lowest angle that it reaches.
    rest = int(np.argmin(turned))
    moved = turned[rest:] - turned[rest] >= ONSET_COUNTS * max(count, 0.05)
    return rest + int(np.argmax(moved)) if moved.any() else None


def _breakaway(turned: Array, push: Array, time: Array, test: int, direction: float) -> Breakaway | None:
    still = turned <= turned.min() + 1e-9
    if not still.any():
        return None
    first = int(np.argmax(still))
    peak = first + int(np.argmax(push[first:]))
    start = max(first, peak - round(RISING_S / 1e-3))
    if peak - start < round(SHORTEST_STICK_S / 1e-3):
        return None
    slope, level = np.polyfit(time[start : peak + 1] - time[peak], push[start : peak + 1], 1)
    rise = float(slope) * 1e-3
    # It broke away somewhere in the sample after the largest reading.
    return Breakaway(test, direction, float(level) + 0.5 * rise, rise, float(time[peak])) if rise > 0 else None


def _unsteady(turned: Array, time: Array, push: Array, expected: float, count: float, broke: Breakaway | None) -> str | None:
    if len(turned) * 1e-3 < SHORTEST_PLATEAU_S:
        return "too short after breakaway"
    speed = float(np.polyfit(time, turned, 1)[0])
    if abs(speed - expected) > SAME_SPEED * expected:
        return "the arm does not move at the pump's speed"
    standing = longest_stand(turned) * 1e-3
    if standing > max(5.0 * count / expected, 0.02):
        return STICKS
    if broke is not None and broke.rise > 0 and rising_share(push, broke.rise) > STICK_SHARE:
        return STICKS
    return None


def rising_share(push: Array, rise: float) -> float:
    """Return the share of a stroke in which the force rises about as fast as while the arm is held (``rise``, N/ms).

    Short sticks hide in the counts of the encoder; the force shows them as a sawtooth.
    """
    from scipy.signal import savgol_filter

    if len(push) < STICK_SAMPLES:
        return 0.0
    slope = savgol_filter(push, STICK_SAMPLES, 1, deriv=1)
    return float(np.mean(slope > STICK_SLOPE * rise))


def longest_stand(turned: Array) -> int:
    """Return the most samples for which the arm stays at one count."""
    edges = np.flatnonzero(np.diff(turned) != 0)
    return int(np.max(np.diff(np.concatenate([[-1], edges, [len(turned) - 1]]))))


def per_test(values: Sequence[tuple[int, float]]) -> Array:
    """Return the mean of each test (tests,): strokes of one test share its friction and are no repetitions."""
    tests: dict[int, list[float]] = {}
    for test, value in values:
        tests.setdefault(test, []).append(value)
    return np.array([np.mean(own) for own in tests.values()])
