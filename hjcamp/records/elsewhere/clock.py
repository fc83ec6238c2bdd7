"""Put the rows of another program's table on the steady clock of a test log."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.import_map import HIGHEST_SAMPLING_HZ, LOWEST_SAMPLING_HZ
from hjcamp.records.log import COMMAND_PHASE
from hjcamp.records.of_plant import LONGEST_PERIOD_S, span

LONGEST_STEP = 1.5  # of the usual one
# Rows are uneven all along, and have no gaps, where such a share of the steps is that long, and none by far longer.
UNEVEN, FARTHEST_STEP = 0.05, 4.0
RATE_TOLERANCE = 0.01
SEEN_UNEVEN = 0.1  # of the usual step
STEADY = 0.01  # of a period: rows this near to a steady clock are taken as they are
DIGITS = 9  # of a period that is read off the rows


def usual_step(time: np.ndarray, where: str, most: float = HIGHEST_SAMPLING_HZ, wanted: float = 0.0) -> float:
    """Return the usual time between rows, s; refuse a time that stands still, jumps, is slow, or faster than ``most`` Hz.

    Rows that are brought to a ``wanted`` period (s) have a gap where one is longer than that allows.
    """
    steps = np.diff(time)
    if (steps <= 0).any():
        row = int(np.argmax(steps <= 0)) + 1
        raise UsageError(
            f"{where}: time does not increase at row {row + 1}: {time[row - 1]:.9g} s, then {time[row]:.9g} s"
        )
    usual = float(np.median(steps))
    if 1 / usual > most * (1 + RATE_TOLERANCE):
        raise UsageError(
            f"{where}: {1 / usual:.4g} rows a second, the whole table is {time[-1] - time[0]:.4g} s; no logger is faster than "
            f"{most:g} Hz (is the unit of time_s right? s read as ms are 1000 times too short)"
        )
    if usual > LONGEST_PERIOD_S:
        raise UsageError(
            f"{where}: rows are {usual:.4g} s apart, at most {LONGEST_PERIOD_S:g} s (is the unit of time_s right?)"
        )
    usual, rounding = _between_ticks(steps, usual)
    if wanted and wanted < usual * (1 - RATE_TOLERANCE):
        raise UsageError(f"{where}: resample_s is {wanted:g}, rows are {span(usual)} apart: samples between rows would be made up")
    longest = LONGEST_STEP * max(usual, wanted)
    if (steps - rounding > longest).any():
        long = steps - rounding > longest
        row, number = int(np.argmax(long)), int(long.sum())
        # a longer period mends rows that are uneven all along, and loses what the others tell where a few are missing
        everywhere = number > UNEVEN * len(steps) and steps.max() < FARTHEST_STEP * usual
        uneven = (
            f", or, as the rows are uneven all along, say in the map resample_s: {float(steps.max()) / LONGEST_STEP:.3g}"
            if everywhere else ""
        )  # fmt: skip
        more = f", the first of {number}" if number > 1 else ""
        raise UsageError(
            f"{where}: gap of {span(steps[row])} after row {row + 1} (time {time[row]:.9g} s){more}, where rows are {span(usual)} "
            f"apart; import what is before and after it as tests of their own{uneven}"
        )
    return usual


def uneven_words(time: np.ndarray, period: float) -> str:
    """Say how far rows are apart that are uneven beyond the ticks of their stamps; empty where they are even."""
    steps = np.diff(time)
    usual, rounding = _between_ticks(steps, float(np.median(steps)))
    # stamps of a steady clock stay within a tick of it; rows of two rates do not
    if np.ptp(time - usual * np.arange(len(time))) > 2.0 * rounding:
        rounding = 0.0
    if np.abs(steps - usual).max() - rounding <= SEEN_UNEVEN * usual:
        return ""
    return (
        f"rows are {span(steps.min())} to {span(steps.max())} apart: brought to one each {span(period)}, what lies between rows is "
        "on a line, or held"
    )


def _between_ticks(steps: np.ndarray, usual: float) -> tuple[float, float]:
    """Return the usual step and by how much a step may be longer because stamps are whole ticks of a slow clock (ms), s.

    Rows that are a broken number of ticks apart have steps of a tick more and a tick less: their mean is the usual one.
    Where rows are whole ticks apart a longer step is a gap.
    """
    grain = usual * 1e-6  # what floating point does to a stamp
    apart = np.diff(np.unique(np.round(steps / grain))) * grain
    tick = float(apart.min()) if len(apart) else 0.0
    if tick > usual * (1 + RATE_TOLERANCE):
        return usual, 0.0
    near = steps[np.abs(steps - usual) <= tick * (1 + RATE_TOLERANCE)]
    mean = float(near.mean())
    whole = np.abs(steps / tick - np.round(steps / tick)).max() <= STEADY if tick else False
    if not whole or abs(mean / tick - round(mean / tick)) <= STEADY:
        return usual, 0.0
    return mean, tick


def refuse_slow(usual: float, where: str) -> None:
    """Raise UsageError for a table with too few rows a second to be resampled to 1 kHz."""
    if 1 / usual < LOWEST_SAMPLING_HZ * (1 - RATE_TOLERANCE):
        raise UsageError(
            f"{where}: {1 / usual:.4g} rows a second; below {LOWEST_SAMPLING_HZ:g} Hz too little is left of a test "
            "(is the unit of time_s right?)"
        )


def steady_period(time: np.ndarray, given: float | None) -> float:
    """Return the period of the log, s: what the map gives, else the mean time between rows."""
    mean = float(time[-1] - time[0]) / (len(time) - 1)
    return given or float(f"{mean:.{DIGITS}g}")


def resample(
    columns: Mapping[str, np.ndarray], time: np.ndarray, period: float, held: Collection[str], where: str
) -> dict[str, np.ndarray]:
    """Return columns of shape (samples,), one sample each ``period`` (s), of columns of shape (rows,) at ``time`` (s).

    Time 0 is the first row of phase 3, or the first of all where there is no phase. Rows on such a clock are taken as they
    are; between others lies a straight line, or the value before for the fields in ``held``. Raises UsageError without a phase 3.
    """
    phase = columns.get("phase")
    first = 0
    if phase is not None:
        if not (phase == COMMAND_PHASE).any():
            raise UsageError(f"{where}: no row of the command phase (phase 3)")
        first = int(np.argmax(phase == COMMAND_PHASE))
    rows = len(time)
    time = time - time[first]
    clock = (np.arange(rows) - first) * period
    if np.abs(time - clock).max() <= STEADY * period:
        return {"time_s": clock} | {name: values for name, values in columns.items() if name != "time_s"}
    tolerance = 1e-6  # of a sample: what rounding may cost at either end
    begin = int(np.ceil(time[0] / period - tolerance))
    end = int(np.floor(time[-1] / period + tolerance))
    if end - begin < 1:
        raise UsageError(f"{where}: {span(time[-1] - time[0])} of rows are no two samples {span(period)} apart: resample_s is too long")
    clock = np.arange(begin, end + 1) * period
    before = np.searchsorted(time, clock + tolerance * period, side="right") - 1
    resampled = {"time_s": clock}
    for name, values in columns.items():
        if name in held or name == "phase":
            resampled[name] = values[np.clip(before, 0, rows - 1)]
        elif name != "time_s":
            resampled[name] = np.interp(clock, time, values)
    return resampled
