"""Gain and phase of a pump or a loop from tests with sines, and the bandwidth that follows."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Series
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
HALF_POWER_DB = 20.0 * math.log10(math.sqrt(0.5))
FEWEST_PERIODS = 2
SMALLEST = 0.01


@dataclass(frozen=True)
class Point:
    """One frequency of one case: ``ratio`` is output over input, mean of the repetitions."""

    case: str
    frequency: float
    ratio: complex


def ratio_at(time: Array, given: Array, answer: Array, frequency: float) -> complex:
    """Return output over input at a frequency in Hz, from whole periods in the second half of a test, settled.

    Both are fitted by a sine, a cosine, a constant and a slope. `UsageError` for less than two whole periods in that
    half and for a frequency above half the sampling rate.
    """
    rate = 1.0 / float(np.median(np.diff(time)))
    if frequency > 0.5 * rate:
        raise UsageError(f"{frequency:g} Hz cannot be seen at {rate:g} samples a second: at most {0.5 * rate:g} Hz")
    periods = math.floor(0.5 * float(time[-1] - time[0]) * frequency + 1e-6)
    if periods < FEWEST_PERIODS:
        raise UsageError(f"a sine of {frequency:g} Hz needs a test of {2 * FEWEST_PERIODS / frequency:.3g} s or more")
    last = time >= time[-1] - periods / frequency - 1e-9
    angle = 2.0 * math.pi * frequency * time[last]
    base = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle), time[last] - time[last][0]])
    (a, b), (c, d) = (np.linalg.lstsq(base, one[last], rcond=None)[0][:2] for one in (given, answer))
    return complex(c, -d) / complex(a, -b)


def points_of(logs: Iterable[TestLog], configuration: Mapping[str, Mapping[str, Any]]) -> list[Point]:
    """Return a point for each case and frequency; ``configuration`` is the configuration of each condition.

    Open loop with blocked cylinders is the pump alone, motor over command; all else is the loop, arm over reference.
    """
    ratios: dict[tuple[str, float], list[complex]] = {}
    for log in logs:
        config = configuration[log.condition_key]
        frequency, command = float(config["trajectory"]["frequency_hz"]), log.command_phase
        alone = config["controller"]["name"] == "open_loop" and config["joint"]["name"] == "blocked"
        given, answer = ("command_deg", "pump_deg") if alone else ("reference_deg", "arm_deg")
        what = f"{config['pump']['name']}, {config['amplifier']['name'].replace('_', ' ')}"
        case = f"{what}, pump alone" if alone else f"{what}, loop with {config['controller']['name']}"
        ratio = ratio_at(command["time_s"], command[given], command[answer], frequency)
        ratios.setdefault((case, frequency), []).append(ratio)
    return [Point(case, frequency, complex(np.mean(found))) for (case, frequency), found in sorted(ratios.items())]


def bandwidth(points: Sequence[Point]) -> tuple[float, float] | None:
    """Return the lowest frequency (Hz) at which the gain crosses -3 dB, and the phase (deg) there; None where it does not.

    Gain in dB over the logarithm of the frequency is taken as straight between neighbours.
    """
    level, phase = gains_db(points), phases_deg(points)
    for place in range(1, len(points)):
        if level[place - 1] >= HALF_POWER_DB > level[place]:
            share = (level[place - 1] - HALF_POWER_DB) / (level[place - 1] - level[place])
            low, high = math.log(points[place - 1].frequency), math.log(points[place].frequency)
            return math.exp(low + share * (high - low)), phase[place - 1] + share * (phase[place] - phase[place - 1])
    return None


def gains_db(points: Sequence[Point]) -> list[float]:
    """Return the gain of each point, dB."""
    return [20.0 * math.log10(max(abs(one.ratio), 1e-12)) for one in points]


def phases_deg(points: Sequence[Point]) -> list[float]:
    """Return the phase of each point, deg, without jumps of a turn from one to the next."""
    return [float(one) for one in np.degrees(np.unwrap([cmath.phase(point.ratio) for point in points]))]


def bode_charts(points: Sequence[Point]) -> tuple[str, list[Chart]]:
    """Return a sentence with the bandwidth of each case, and the two charts of a Bode figure.

    What answers with less than 1 % of the input is left out: the encoders' steps, not the system, make its phase.
    """
    cases: dict[str, list[Point]] = {}
    for one in points:
        if abs(one.ratio) >= SMALLEST:
            cases.setdefault(one.case, []).append(one)
    said: list[str] = []
    gain: list[Series] = []
    phase: list[Series] = []
    for number, (case, own) in enumerate(cases.items()):
        found = bandwidth(own)
        said.append(f"{case}: {f'-3 dB at {found[0]:.1f} Hz, phase {found[1]:.0f} deg' if found else 'no -3 dB reached'}")
        x = np.array([one.frequency for one in own])
        for series, values in ((gain, gains_db(own)), (phase, phases_deg(own))):
            series.append(Series(x, np.asarray(values), case, "line", number))
            series.append(Series(x, np.asarray(values), "", "points", number))
    x = np.array([min(one.frequency for one in points), max(one.frequency for one in points)])
    gain.append(Series(x, np.full(2, HALF_POWER_DB), "-3 dB", "dashed", 3))
    label = "Frequency (Hz)"
    return "; ".join(said), [
        Chart("gain", "", "Gain of output over input", label, "Gain (dB)", tuple(gain), logarithmic_x=True),
        Chart("phase", "", "Phase of output over input", label, "Phase (deg)", tuple(phase), logarithmic_x=True),
    ]
