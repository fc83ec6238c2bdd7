"""dp/dV of a line from tests with a blocked joint, where the pump's water can do nothing but raise the pressure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.plants.pump_joint.calibrate.constants import Constants, pump_travel
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Estimate, Finding, Series, mean_interval
from hjcamp.plants.pump_joint.calibrate.kinds import STILL_DEG
from hjcamp.plants.pump_joint.sizing.tubing import ATMOSPHERE, air_fraction, tubing_modulus, tubing_volume
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
SMALLEST_RISE_MPA = 0.02
BIN_MPA = 0.04
PARTS = 10
FEWEST_SAMPLES = 20
LINEAR = 0.05  # of dp/dV: how far a part of the range may be off
SCALE = 1e-15  # Pa/m^3 to MPa/mm^3


class Line(NamedTuple):
    """One line in one test: volume pushed in (n,) m^3, pressure (n,) MPa, time (n,) s."""

    volume: Array
    pressure: Array
    time: Array


class Piece(NamedTuple):
    """A part of a line: mean pressure (MPa), dp/dV (Pa/m^3), and which samples."""

    pressure: float
    slope: float
    rows: NDArray[np.intp]


def lines_of(log: TestLog, constants: Constants) -> tuple[Line, Line]:
    """Return both lines of a compliance test; raises UsageError where the joint moved or the pressure hardly did."""
    columns = log.command_phase
    arm = columns["arm_deg"]
    if float(np.ptp(arm)) > STILL_DEG:
        raise UsageError(f"{log.path}: the arm turns by {np.ptp(arm):.3g} deg; a compliance test needs a blocked joint")
    moved = columns["pump_deg"] if "pump_deg" in columns else columns["command_deg"]
    volume = constants.pump_area * pump_travel(moved - moved[0], constants)
    found = tuple(
        Line(sign * volume, columns[f"pressure{number}_mpa"], columns["time_s"]) for number, sign in ((1, 1.0), (2, -1.0))
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


def pieces_of(line: Line) -> list[Piece]:
    """Return the line in ten parts of equal volume, each with its pressure (MPa) and its own dp/dV (Pa/m^3)."""
    edges = np.linspace(line.volume.min(), line.volume.max(), PARTS + 1)
    part = np.clip(np.digitize(line.volume, edges) - 1, 0, PARTS - 1)
    found = []
    for number in range(PARTS):
        rows = np.flatnonzero(part == number)
        if len(rows) >= FEWEST_SAMPLES and np.ptp(line.volume[rows]) > 0:
            own = Line(line.volume[rows], line.pressure[rows], line.time[rows])
            found.append(Piece(float(own.pressure.mean()), slope_of(own), rows))
    return found


def valid_range(pieces: Sequence[Piece]) -> tuple[float, float] | None:
    """Return the widest range (MPa gauge) in which the local dp/dV is the usual one within 5 %; None without one.

    The usual one is the median over all parts; twice the standard error of a range's parts is allowed in addition.
    """
    pressure, slope = np.array([one.pressure for one in pieces]), np.array([one.slope for one in pieces])
    usual = float(np.median(slope))
    edges = np.arange(pressure.min(), pressure.max() + BIN_MPA, BIN_MPA)
    owner = np.digitize(pressure, edges)
    runs: list[list[float]] = []
    going = False
    for number in range(1, len(edges) + 1):
        own = slope[owner == number]
        if not len(own):
            continue
        error = float(own.std(ddof=1) / np.sqrt(len(own))) if len(own) > 1 else 0.0
        fits = abs(float(own.mean()) - usual) <= LINEAR * usual + min(2.0 * error, LINEAR * usual)
        if fits and not going:
            runs.append([])
        if fits:
            runs[-1] += list(pressure[owner == number])
        going = fits
    widest = max(runs, key=lambda run: max(run) - min(run), default=None)
    return None if widest is None else (min(widest), max(widest))


def identify_compliance(logs: Sequence[TestLog], constants: Constants) -> Finding:
    """Return dp/dV with its range of validity, the effective bulk modulus, and the air content that it implies."""
    tests = [lines_of(log, constants) for log in logs]
    every = [line for pair in tests for line in pair]
    parts = [[pieces_of(line) for line in pair] for pair in tests]
    per_test = [float(np.mean([slope_of(line) for line in pair])) for pair in tests]
    valid = valid_range([piece for pair in parts for line in pair for piece in line])
    warnings = []
    low, high = min(float(line.pressure.min()) for line in every), max(float(line.pressure.max()) for line in every)
    if valid is not None and (valid[0] > low + BIN_MPA or valid[1] < high - BIN_MPA):
        warnings.append(
            f"dp/dV is constant within 5 % between {valid[0]:.2f} and {valid[1]:.2f} MPa gauge alone; the tests went "
            f"from {low:.2f} to {high:.2f} MPa (bubbles at low pressure, or a line at its vapour pressure)"
        )
        inside = [
            [_cut(line, own, valid) for line, own in zip(pair, pieces, strict=True)]
            for pair, pieces in zip(tests, parts, strict=True)
        ]
        found = [[slope_of(line) for line in pair if line is not None] for pair in inside]
        per_test = [float(np.mean(slopes)) for slopes in found if slopes] or per_test
    if valid is None:
        warnings.append("dp/dV differs by more than 5 % all over the range: the line is not linear")
        valid = low, high
    mean, interval = mean_interval(per_test, _resolution(logs[0], constants) / float(np.ptp(every[0].volume)) * per_test[0])
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


def _cut(line: Line, pieces: Sequence[Piece], valid: tuple[float, float]) -> Line | None:
    rows = [piece.rows for piece in pieces if valid[0] <= piece.pressure <= valid[1]]
    if not rows:
        return None
    kept = np.sort(np.concatenate(rows))
    return Line(line.volume[kept], line.pressure[kept], line.time[kept])


def _resolution(log: TestLog, constants: Constants) -> float:
    values = log.command_phase["pump_deg" if "pump_deg" in log.columns else "command_deg"]
    steps = np.diff(np.unique(values))
    return float(constants.pump_area * pump_travel(np.median(steps) if len(steps) else 0.0, constants))


def _moduli(stiffness: Estimate, constants: Constants, middle: float) -> tuple[tuple[Estimate, ...], dict[str, str], list[str]]:
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
    caption = f"Pressure against volume, joint blocked, {counted(len(tests), 'test')}"
    return (Chart("compliance", "4.4.5", caption, "Volume (mm³)", "Pressure (MPa gauge)", tuple(series)),)
