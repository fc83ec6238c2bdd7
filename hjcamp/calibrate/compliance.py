"""dp/dV of a line from tests with a blocked joint, where the pump's water can do nothing but raise the pressure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.calibrate.constants import Constants, pump_travel
from hjcamp.calibrate.estimate import Chart, Estimate, Finding, Series, mean_interval
from hjcamp.calibrate.kinds import STILL_DEG
from hjcamp.calibrate.tubing import ATMOSPHERE, air_fraction, tubing_modulus, tubing_volume
from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
SMALLEST_RISE_MPA = 0.02
BIN_MPA = 0.04
LINEAR = 0.05  # of dp/dV: how far a part of the range may be off
SCALE = 1e-15  # Pa/m^3 to MPa/mm^3


class Line(NamedTuple):
    """One line in one test: volume pushed in (n,) m^3, pressure (n,) MPa, time (n,) s."""

    volume: Array
    pressure: Array
    time: Array


def lines_of(log: TestLog, constants: Constants) -> tuple[Line, Line]:
    """Return both lines of a compliance test; raises UsageError where the joint moved or the pressure hardly did."""
    columns = log.command_phase
    arm = columns["arm_deg"]
    if float(np.ptp(arm)) > STILL_DEG:
        raise UsageError(f"{log.path}: the arm turns by {np.ptp(arm):.3g} deg; a compliance test needs a blocked joint")
    moved = columns["pump_deg"] if "pump_deg" in columns else columns["command_deg"]
    volume = constants.pump_area * pump_travel(moved - moved[0], constants)
    found = tuple(
        Line(sign * volume, columns[f"pressure{number}_mpa"], columns["time_s"])
        for number, sign in ((1, 1.0), (2, -1.0))
    )
    rise = max(float(np.ptp(line.pressure)) for line in found)
    if rise < SMALLEST_RISE_MPA:
        raise UsageError(f"{log.path}: the pressures change by {rise:.2g} MPa only; move the pump further")
    return found[0], found[1]


def slope_of(line: Line) -> float:
    """Return dp/dV in Pa/m^3: least squares of p = a + K V + b t; the drift b takes a slow leak out.

    Source: thesis 4.4.3 and Figure 4.4.5; solver: numpy.linalg.lstsq.
    """
    volume = line.volume / np.ptp(line.volume)
    columns = [np.ones_like(volume), volume]
    # Without a turn of the pump, time and volume are the same thing and a drift cannot be told.
    if abs(float(np.corrcoef(line.volume, line.time)[0, 1])) < 0.9:
        columns.append(line.time - line.time[0])
    answer = np.linalg.lstsq(np.column_stack(columns), line.pressure, rcond=None)[0]
    return float(answer[1] / np.ptp(line.volume)) * 1e6


def local_slopes(lines: Sequence[Line]) -> tuple[Array, Array, Array]:
    """Return pressures (MPa), dp/dV there (Pa/m^3) and its standard error, in bins of 0.04 MPa over all lines."""
    low = min(float(line.pressure.min()) for line in lines)
    high = max(float(line.pressure.max()) for line in lines)
    edges = np.arange(low, high + BIN_MPA, BIN_MPA)
    middles, slopes, errors = [], [], []
    for start in edges[:-1]:
        inside = [_within(line, start, start + BIN_MPA) for line in lines]
        own = np.array([slope_of(part) for part in inside if part is not None])
        if len(own):
            middles.append(start + 0.5 * BIN_MPA)
            slopes.append(float(own.mean()))
            errors.append(float(own.std(ddof=1) / np.sqrt(len(own))) if len(own) > 1 else np.inf)
    return np.array(middles), np.array(slopes), np.array(errors)


def _within(line: Line, low: float, high: float) -> Line | None:
    # The bin is cut by volume: a cut by the noisy pressure itself would flatten the slope.
    slope, start = np.polyfit(line.volume * 1e9, line.pressure, 1)
    expected = start + slope * line.volume * 1e9
    rows = (expected >= low) & (expected < high)
    if np.count_nonzero(rows) < 20 or float(np.ptp(expected[rows])) < 0.8 * (high - low):
        return None
    return Line(line.volume[rows], line.pressure[rows], line.time[rows])


def valid_range(pressures: Array, slopes: Array, errors: Array, slope: float) -> tuple[float, float] | None:
    """Return the widest range (MPa gauge) in which the local dp/dV is that of the whole within 5 %."""
    fits = np.abs(slopes - slope) <= LINEAR * slope + 2.0 * np.where(np.isfinite(errors), errors, 0.0)
    best: tuple[int, int] | None = None
    start = None
    for index, good in enumerate([*fits, False]):
        if good and start is None:
            start = index
        elif not good and start is not None:
            if best is None or index - start > best[1] - best[0]:
                best = start, index
            start = None
    if best is None:
        return None
    return float(pressures[best[0]] - 0.5 * BIN_MPA), float(pressures[best[1] - 1] + 0.5 * BIN_MPA)


def identify_compliance(logs: Sequence[TestLog], constants: Constants) -> Finding:
    """Return dp/dV with its range of validity, the effective bulk modulus, and the air content that it implies."""
    tests = [lines_of(log, constants) for log in logs]
    every = [line for pair in tests for line in pair]
    pressures, slopes, errors = local_slopes(every)
    per_test = [float(np.mean([slope_of(line) for line in pair])) for pair in tests]
    middle, _ = mean_interval(per_test)
    valid = valid_range(pressures, slopes, errors, middle) if len(pressures) else None
    warnings = []
    low, high = min(float(line.pressure.min()) for line in every), max(float(line.pressure.max()) for line in every)
    if valid is not None and (valid[0] > low + BIN_MPA or valid[1] < high - BIN_MPA):
        warnings.append(
            f"dp/dV is constant within 5 % between {valid[0]:.2f} and {valid[1]:.2f} MPa gauge alone; the tests went "
            f"from {low:.2f} to {high:.2f} MPa (bubbles at low pressure, or a line at its vapour pressure)"
        )
        cut = [[_cut(line, valid) for line in pair] for pair in tests]
        whole = [pair for pair in cut if all(len(line.time) for line in pair)]
        per_test = [float(np.mean([slope_of(line) for line in pair])) for pair in whole] or per_test
    if valid is None:
        warnings.append("dp/dV differs by more than 5 % all over the range: the line is not linear")
        valid = low, high
    mean, interval = mean_interval(per_test, _resolution(logs[0], constants) / float(np.ptp(every[0].volume)) * middle)
    first = Estimate(
        "line_stiffness", mean, "Pa/m^3", interval, len(per_test), "dp/dV of one line", "MPa/mm³", SCALE,
        constants.published.get("line_stiffness"),
    )  # fmt: skip
    facts = {"dp/dV holds between": f"{max(valid[0], low):.2f} and {min(valid[1], high):.2f} MPa gauge"}
    moduli, more, further = _moduli(first, constants, 0.5 * (valid[0] + valid[1]))
    sides = [float(np.mean([slope_of(pair[number]) for pair in tests])) * SCALE for number in (0, 1)]
    facts["line 1, line 2"] = f"{sides[0]:.4g}, {sides[1]:.4g} MPa/mm³"
    if abs(sides[0] - sides[1]) > LINEAR * sum(sides) / 2:
        warnings.append("the two lines differ by more than 5 %; the model has one dp/dV for both")
    chart = _chart(tests, mean)
    return Finding("compliance", (first, *moduli), chart, (*warnings, *further), facts | more)


def _cut(line: Line, valid: tuple[float, float]) -> Line:
    return _within(line, *valid) or Line(line.volume[:0], line.pressure[:0], line.time[:0])


def _resolution(log: TestLog, constants: Constants) -> float:
    values = log.command_phase["pump_deg" if "pump_deg" in log.columns else "command_deg"]
    steps = np.diff(np.unique(values))
    return float(constants.pump_area * pump_travel(np.median(steps) if len(steps) else 0.0, constants))


def _moduli(
    stiffness: Estimate, constants: Constants, middle: float
) -> tuple[tuple[Estimate, ...], dict[str, str], list[str]]:
    tubing = constants.tubing
    names = ("inner_diameter_mm", "outer_diameter_mm", "length_mm", "youngs_modulus_mpa", "poisson_ratio", "water")
    if any(tubing.get(name) is None for name in names):
        return (), {}, ["the tubing's dimensions are not known: no bulk modulus, no air content"]
    inner, outer = tubing["inner_diameter_mm"] * 1e-3, tubing["outer_diameter_mm"] * 1e-3
    volume = tubing_volume(inner, tubing["length_mm"] * 1e-3)
    interval = None if stiffness.interval is None else tuple(end * volume for end in stiffness.interval)
    effective = Estimate(
        "effective_modulus", stiffness.value * volume, "Pa", interval, stiffness.tests,  # type: ignore[arg-type]
        "effective bulk modulus of the tubing's water (4.4.3.13)", "MPa", 1e-6,
    )  # fmt: skip
    wall = tubing_modulus(inner, outer, tubing["youngs_modulus_mpa"] * 1e6, tubing["poisson_ratio"])
    water = tubing["water"]["bulk_modulus_mpa"] * 1e6
    absolute = middle * 1e6 + ATMOSPHERE
    share = air_fraction(effective.value, water, wall, absolute)
    facts = {"tubing alone by 4.4.3.11": f"{wall * 1e-6:.3g} MPa", "air content by 4.4.3.14": f"{share * 100:.2g} %"}
    if share < 0:
        return (effective,), facts, ["the line is stiffer than its tubing by 4.4.3.11: no air content follows"]
    return (effective,), facts, []


def _chart(tests: Sequence[tuple[Line, Line]], slope: float) -> tuple[Chart, ...]:
    series = []
    for number in (0, 1):
        for index, pair in enumerate(tests):
            line = pair[number]
            label = f"line {number + 1}" if index == 0 else ""
            series.append(Series(line.volume[::5] * 1e9, line.pressure[::5], label, "faint", number))
    first = tests[0][0]
    volume = np.array([min(line.volume.min() for line in tests[0]), max(line.volume.max() for line in tests[0])])
    start = float(np.mean(first.pressure) - slope * 1e-6 * np.mean(first.volume))
    series.append(Series(volume * 1e9, start + slope * 1e-6 * volume, f"{slope * SCALE:.4g} MPa/mm³", "dashed", 2))
    caption = f"Pressure against volume, joint blocked, {len(tests)} tests"
    return (Chart("compliance", "4.4.5", caption, "Volume (mm³)", "Pressure (MPa gauge)", tuple(series)),)
