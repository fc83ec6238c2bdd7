"""How fast a held line loses pressure, and the pressure above which it loses more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Estimate, Finding, Series, mean_interval
from hjcamp.plants.pump_joint.calibrate.kinds import PUMP_STILL_DEG, STILL_DEG
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
SHORTEST_S = 1.0
SHOWN_MPA = (0.62, 0.60, 0.56, 0.40)
THINNED = 10  # samples whose mean is one point of the fit: the decay is slow
STARTS = (0.1, 0.3, 0.5, 0.7, 0.9)
BEYOND = 10.0  # how much a threshold must lower the deviance (Schwarz: 2 ln(1500) = 14.6 for two parameters, less one)


@dataclass(frozen=True)
class Leak:
    """Pressure p (MPa gauge) of a held line falls by ``rate`` * p + ``above`` * max(p - ``threshold``, 0), MPa/s.

    ``threshold`` is NaN, ``above`` 0 where the data show none.
    """

    start: float
    rate: float
    above: float
    threshold: float

    def fall(self, pressure: float) -> float:
        """Return the pressure drop in MPa/s at a pressure in MPa gauge."""
        extra = self.above * max(pressure - self.threshold, 0.0) if self.above > 0 else 0.0
        return self.rate * pressure + extra

    def course(self, time: Array) -> Array:
        """Return the pressure (n,) in MPa after ``time`` (n,) s: two exponentials, joined at the threshold."""
        if not self.above > 0 or self.start <= self.threshold:
            return self.start * np.exp(-self.rate * time)
        total = self.rate + self.above
        level = self.above * self.threshold / total
        fast = level + (self.start - level) * np.exp(-total * time)
        if level >= self.threshold:
            return fast
        crossing = math.log((self.start - level) / (self.threshold - level)) / total
        slow = self.threshold * np.exp(-self.rate * np.maximum(time - crossing, 0.0))
        return np.where(time < crossing, fast, slow)


def fit_leak(time: Array, pressure: Array, noise: float) -> Leak:
    """Return the leak that the pressure (n,) in MPa of a held line shows; ``noise`` (MPa) is that of one value.

    Least squares of the closed solution; a threshold is kept where it lowers the deviance by more than chance can.
    Source: thesis 4.4.4; scipy.optimize.least_squares; Schwarz (1978), Ann. Statist. 6, 461.
    """
    from scipy.optimize import least_squares

    start, end = float(np.mean(pressure[:5])), float(np.mean(pressure[-20:]))
    span = max(float(time[-1] - time[0]), 1e-3)
    since = time - time[0]
    rate = max(math.log(max(start, 1e-3) / max(end, 1e-3)) / span, 0.0)

    def plain(x: Array) -> Array:
        return (x[0] * np.exp(-x[1] * since) - pressure) / noise

    simple = least_squares(plain, [start, rate], x_scale=[0.1, 0.01])
    best, leak = 2.0 * simple.cost, Leak(float(simple.x[0]), float(simple.x[1]), 0.0, math.nan)
    if start - end < 6.0 * noise:
        return leak
    low, high = min(end, start), max(end, start)
    goal = best - BEYOND - 2.0 * math.log(len(time))
    for share in STARTS:
        for above in (0.3, 3.0):
            first = [start, 0.5 * rate + 1e-5, above, low + share * (high - low)]
            bounds = ([0.0, -0.1, 0.0, low], [2.0 * high, 5.0, 50.0, high])
            found = least_squares(
                lambda x: (Leak(*x).course(since) - pressure) / noise,
                np.clip(first, np.add(bounds[0], 1e-9), np.subtract(bounds[1], 1e-9)),
                bounds=bounds,
                x_scale=[0.1, 0.01, 1.0, 0.01],
                max_nfev=100,
            )
            if 2.0 * found.cost < goal:
                goal, leak = 2.0 * found.cost, Leak(*(float(value) for value in found.x))
    return leak


def held_lines(log: TestLog) -> list[tuple[Array, Array]]:
    """Return time (s) and pressure (MPa) of both lines, thinned; UsageError where one moves or it is short."""
    columns = log.command_phase
    for name, limit in (("arm_deg", STILL_DEG), ("pump_deg", PUMP_STILL_DEG)):
        if name in columns and float(np.ptp(columns[name])) > limit:
            raise UsageError(f"{log.path}: {name} moves by {np.ptp(columns[name]):.3g} deg; a leakage test holds both")
    blocks = len(columns["time_s"]) // THINNED
    if blocks * THINNED * 1e-3 < SHORTEST_S:
        raise UsageError(f"{log.path}: {len(columns['time_s'])} samples are too few to see a leak; hold for 15 s")
    rows = slice(0, blocks * THINNED)
    time = columns["time_s"][rows].reshape(blocks, THINNED).mean(axis=1)
    return [(time, columns[f"pressure{number}_mpa"][rows].reshape(blocks, THINNED).mean(axis=1)) for number in (1, 2)]


def identify_leakage(logs: Sequence[TestLog], stiffness: float, noise: float) -> Finding:
    """Return the rate of leakage against pressure, and the threshold.

    ``stiffness`` is dp/dV in Pa/m^3, which turns rates into the conductances of effect ``leakage``; ``noise`` (Pa) is
    that of a pressure sample.
    """
    scale = max(noise * 1e-6 / math.sqrt(THINNED), 1e-6)
    tests = [held_lines(log) for log in logs]
    leaks = [[fit_leak(time, pressure, scale) for time, pressure in lines] for lines in tests]
    low = min(float(pressure[-20:].mean()) for lines in tests for _, pressure in lines)
    high = max(float(pressure[:5].mean()) for lines in tests for _, pressure in lines)
    estimates, warnings = [], []

    def add(name: str, values: Sequence[float], unit: str, text: str, shown: str, factor: float) -> None:
        mean, interval = mean_interval(values)
        estimates.append(Estimate(name, mean, unit, interval, len(values), text, shown, factor))

    for level in SHOWN_MPA:
        if low <= level <= high:
            name = f"leak_rate_{level * 1000:.0f}_kpa"
            falls = [float(np.mean([leak.fall(level) for leak in pair])) * 1e6 for pair in leaks]
            add(name, falls, "Pa/s", f"pressure drop at {level:.2f} MPa gauge", "MPa/s", 1e-6)
    rates = [float(np.mean([leak.rate for leak in pair])) for pair in leaks]
    add("leakage.conductance", [rate / stiffness for rate in rates], "m^3/(s*Pa)", "leak", "mm³/s/MPa", 1e15)
    clear = [[leak for leak in pair if leak.above > 0] for pair in leaks]
    share = sum(len(pair) for pair in clear) / (2 * len(leaks))
    if share > 0.5:
        known = [pair for pair in clear if pair]
        thresholds = [float(np.mean([leak.threshold for leak in pair])) * 1e6 for pair in known]
        above = [float(np.mean([leak.above for leak in pair])) / stiffness for pair in known]
        add("leakage.threshold", thresholds, "Pa", "pressure above which the fittings open", "MPa gauge", 1e-6)
        add("leakage.conductance_above", above, "m^3/(s*Pa)", "further leak above it", "mm³/s/MPa", 1e15)
        if share < 1.0:
            warnings.append(f"the threshold shows in {share * 100:.0f} % of the lines alone")
    else:
        warnings.append(f"no threshold shows between {low:.2f} and {high:.2f} MPa gauge; hold at a higher pressure")
    least = scale / (len(tests[0][0][0]) ** 0.5 * tests[0][0][0][-1]) * 6.0
    if float(np.mean(rates)) * 0.5 * (low + high) < least:
        warnings.append(f"no leak above {least:.2g} MPa/s can be distinguished from the sensors' noise")
    facts = {"pressures tested": f"{low:.2f} to {high:.2f} MPa gauge"}
    return Finding("leakage", tuple(estimates), _chart(tests, leaks), tuple(warnings), facts)


def _chart(tests: Sequence[Sequence[tuple[Array, Array]]], leaks: Sequence[Sequence[Leak]]) -> tuple[Chart, ...]:
    series = []
    for number in (0, 1):
        for index, lines in enumerate(tests):
            time, pressure = lines[number]
            series.append(Series(time[::5], pressure[::5], f"line {number + 1}" if index == 0 else "", "faint", number))
    time = tests[0][0][0]
    series.append(Series(time, leaks[0][0].course(time - time[0]), "model of one test", "dashed", 2))
    caption = f"Pressure of the held lines, {len(tests)} tests"
    return (Chart("leakage", "4.4.6", caption, "Time (s)", "Pressure (MPa gauge)", tuple(series)),)
