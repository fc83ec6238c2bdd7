"""Noise, resolution and zero of the sensors, and how far repetitions scatter, from logs of any kind."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.calibrate.estimate import Estimate, Finding, mean_interval
from hjcamp.records.find import group_by_condition
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
REST_SAMPLES = 5
VENTED_MPA = 0.01
LONGEST_COUNT_DEG = 2.0


def pressure_noise(pressure: Array) -> float:
    """Return the standard deviation of white noise in a pressure (n,), in its own unit.

    .. math:: \\sigma = 1.4826\\,\\mathrm{median}|p_{k+1} - 2 p_k + p_{k-1}| / \\sqrt 6

    Second differences leave slow changes out, the median the fast ones. Source: Rice (1984), Ann. Statist. 12, 1215;
    Gasser, Sroka & Jennen-Steinmetz (1986), Biometrika 73, 625.
    """
    second = np.diff(pressure, 2)
    return float(1.4826 * np.median(np.abs(second)) / math.sqrt(6.0)) if len(second) else 0.0


def smallest_step(values: Array) -> float | None:
    """Return the resolution of a counting sensor: the smallest step between its readings; None where it shows none."""
    steps = np.diff(np.unique(np.round(values, 9)))
    if len(steps) < 3:
        return None
    step = float(steps.min())
    # Every reading lies on the grid of a counter; one that does not is an analog value.
    grid = (values - values[0]) / step
    on_grid = float(np.max(np.abs(grid - np.round(grid)))) < 0.05
    return step if on_grid and step < LONGEST_COUNT_DEG else None


def identify_sensors(logs: Sequence[TestLog]) -> Finding:
    """Return noise and resolution of the sensors, their zeros where the logs tell, and the scatter of repetitions."""
    estimates: list[Estimate] = []
    warnings: list[str] = []

    def add(name: str, values: Sequence[float], unit: str, text: str, shown: str, scale: float) -> None:
        mean, interval = mean_interval(values)
        estimates.append(Estimate(name, mean, unit, interval, len(values), text, shown, scale))

    quiet = [log for log in logs if float(np.ptp(log.command_phase["arm_deg"])) < 1.1] or list(logs)
    noises = [
        float(np.mean([pressure_noise(log.columns[f"pressure{number}_mpa"]) for number in (1, 2)])) * 1e6 for log in quiet
    ]
    add("pressure_noise", noises, "Pa", "noise of a pressure sample", "MPa", 1e-6)
    for field, name, text in (("arm_deg", "encoder_count", "arm encoder"), ("pump_deg", "pump_count", "pump encoder")):
        steps = [smallest_step(log.columns[field]) for log in logs if field in log.columns]
        known = [step for step in steps if step is not None]
        if known:
            count = math.radians(min(known))
            estimates.append(Estimate(name, count, "rad", None, len(known), f"one count, {text}", "deg", 180 / math.pi))
        elif steps:
            warnings.append(f"the resolution of the {text} does not show")
    starts = [math.radians(float(np.mean(log.command_phase["arm_deg"][:REST_SAMPLES]))) for log in logs]
    add("arm_zero", starts, "rad", "arm angle at rest at the start", "deg", 180 / math.pi)
    vented = _vented(logs)
    if vented:
        for number in (1, 2):
            values = [float(np.mean(log.columns[f"pressure{number}_mpa"])) * 1e6 for log in vented]
            add(f"pressure{number}_offset", values, "Pa", f"offset of pressure sensor {number}", "MPa", 1e-6)
    else:
        warnings.append("offsets of the pressure sensors do not show: log a second with both lines open to the air")
    scatter = initial_scatter(logs)
    if scatter is not None:
        value, tests = scatter
        text = "scatter of a line's first pressure"
        estimates.append(Estimate("initial_pressure", value, "Pa", None, tests, text, "MPa", 1e-6))
    return Finding("sensors", tuple(estimates), (), tuple(warnings))


def _vented(logs: Sequence[TestLog]) -> list[TestLog]:
    names = ("pressure1_mpa", "pressure2_mpa")
    return [log for log in logs if all(float(np.max(np.abs(log.columns[name]))) < VENTED_MPA for name in names)]


def initial_scatter(logs: Sequence[TestLog]) -> tuple[float, int] | None:
    """Return how far the first pressure of a line scatters (Pa, standard deviation) and from how many tests.

    From the difference of the lines among repetitions: the preload ends at the same pressure each time, and moves both.
    """
    squares, free, tests = 0.0, 0, 0
    for group in group_by_condition(logs).values():
        if len(group) < 2:
            continue
        first = np.array(
            [
                float(np.mean(log.command_phase["pressure1_mpa"][:REST_SAMPLES]))
                - float(np.mean(log.command_phase["pressure2_mpa"][:REST_SAMPLES]))
                for log in group
            ]
        )
        squares += float(np.sum((first - first.mean()) ** 2))
        free += len(group) - 1
        tests += len(group)
    return (math.sqrt(squares / free / 2.0) * 1e6, tests) if free else None
