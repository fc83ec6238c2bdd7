"""Put the rows of another program's table on the steady clock of a test log."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from hjcamp.errors import UsageError, counted
from hjcamp.records.elsewhere.import_map import ColumnRule
from hjcamp.records.elsewhere.map_values import GAPS_HINT, HIGHEST_SAMPLING_HZ, LOWEST_SAMPLING_HZ
from hjcamp.records.log import COMMAND_PHASE
from hjcamp.records.of_plant import LONGEST_PERIOD_S, span

LONGEST_STEP = 1.5  # of the usual one
# Rows are uneven all along, and have no gaps, where such a share of the steps is that long, and none by far longer.
UNEVEN, FARTHEST_STEP = 0.05, 4.0
RATE_TOLERANCE = 0.01
SEEN_UNEVEN = 0.1  # of the usual step
STEADY = 0.01  # of a period: rows this near to a steady clock are taken as they are
DIGITS = 9  # of a period that is read off the rows
# Rows are lost where some steps are whole multiples of the usual one; more of them than that are another clock.
WHOLE, MOST_LOST = 0.25, 0.25
EVEN = 1.25  # rows between two ticks more of a slow clock, the most over the least
# Of rows that repeat a time so few are switches of a variable step; more of them have stamps that are too coarse.
REPEATED = 0.1
# After what a clock begins again: counts of 16, 24, 31 and 32 bits, and s of a day, an hour, a minute.
TURNS, TURNS_S = (2.0**16, 2.0**24, 2.0**31, 2.0**32), (86_400.0, 3600.0, 60.0)


def last_of_each_time(
    fields: dict[str, np.ndarray], time: np.ndarray, where: str
) -> tuple[dict[str, np.ndarray], np.ndarray, str]:
    """Return columns of shape (rows,) and times, s, with the last row of each time alone, and in words what was left out.

    A variable step has two rows at a switch, before and after it; some loggers write each row twice. Raises UsageError
    where many rows differ at one time: its stamps are too coarse.
    """
    again = np.diff(time) == 0.0
    number = int(again.sum())
    if not number:
        return fields, time, ""
    differ = np.any([np.diff(values)[again] != 0.0 for values in fields.values()], axis=0)
    row = int(np.argmax(again))
    if np.count_nonzero(differ) > REPEATED * len(time):
        raise UsageError(
            f"{where}: {number} of {len(time)} rows have the time of the row before, the first {time[row]:.9g} s: stamps are coarser "
            "than rows; give period_s or sampling_hz and leave time_s out, or map a column of finer times"
        )
    kept = np.append(~again, True)
    said = f"{counted(number, 'row')} at the time of the next, the first at {time[row]:.9g} s: the later one of each is taken"
    return {name: values[kept] for name, values in fields.items()}, time[kept], said


def falls_back(time: np.ndarray, rule: ColumnRule, where: str) -> None:
    """Raise UsageError where time (s), made of a column by ``rule``, goes back; it names the key for a clock that rolls over."""
    steps = np.diff(time)
    if not (steps < 0.0).any():
        return
    row = int(np.argmax(steps < 0.0))
    said = f"{where}: time does not increase at row {row + 2}: {time[row]:.9g} s, then {time[row + 1]:.9g} s"
    size = abs(rule.scale * rule.factor)
    usual = float(np.median(steps))
    turns = [(turn, turn * size) for turn in TURNS] + [(turn / size, turn) for turn in TURNS_S]
    found = next((turn for turn, seconds in turns if 0.0 <= steps[row] + seconds <= LONGEST_STEP * FARTHEST_STEP * usual), None)
    if found is None:
        raise UsageError(
            f"{said}; import two tests in one table as tables of their own; where its clock begins again, say unwrap in the map"
        )
    raise UsageError(
        f"{said}: its clock rolls over; say in the map time_s: {{column: {rule.column}, ..., unwrap: {found:.12g}}}"
    )


def lost_rows(time: np.ndarray) -> np.ndarray | None:
    """Return how many rows were lost in each step (rows - 1,) of a time that a steady clock has stamped; None where none were.

    Steps of one tick more of a slow clock come evenly; lost rows do not.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    if usual <= 0.0:
        return None
    whole = np.rint(steps / usual)
    long = np.flatnonzero(whole > 1)
    if not len(long) or len(long) > MOST_LOST * len(steps) or whole.min() < 1 or whole.max() > FARTHEST_STEP:
        return None
    apart = np.diff(np.concatenate([[-1], long, [len(steps)]]))
    even = len(long) > 2 and whole.max() == 2 and apart.max() <= EVEN * apart[1:-1].min() + 2
    return None if even or np.abs(steps / usual - whole).max() > WHOLE else whole.astype(int) - 1


def usual_step(
    time: np.ndarray, where: str, most: float = HIGHEST_SAMPLING_HZ, wanted: float = 0.0, fill: bool = False
) -> float:
    """Return the usual time between rows, s; refuse a time that jumps, is slow, or faster than ``most`` Hz.

    Rows that are brought to a ``wanted`` period (s) have a gap where one is longer than that allows; single lost rows
    are none where they are to be ``fill``ed in.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    if 1 / usual > most * (1 + RATE_TOLERANCE):
        raise UsageError(
            f"{where}: {1 / usual:.4g} rows a second, the whole table is {time[-1] - time[0]:.4g} s; no logger is faster than "
            f"{most:g} Hz (is the unit of time_s right? s read as ms are 1000 times too short; days of a spreadsheet: unit: day)"
        )
    if usual > LONGEST_PERIOD_S:
        raise UsageError(
            f"{where}: rows are {usual:.4g} s apart, at most {LONGEST_PERIOD_S:g} s (is the unit of time_s right?)"
        )
    lost = lost_rows(time)
    usual, rounding = _between_ticks(steps, usual) if lost is None else (usual, 0.0)
    if wanted and wanted < usual * (1 - RATE_TOLERANCE):
        raise UsageError(
            f"{where}: resample_s is {wanted:g}, rows are {span(usual)} apart: samples between rows would be made up"
        )
    longest = LONGEST_STEP * max(usual, wanted)
    if lost is not None and not wanted:
        if fill:
            return usual
        row = int(np.argmax(lost > 0))
        raise UsageError(
            f"{where}: {_lost_words(lost)}, first a gap of {span(steps[row])} after row {row + 1} (time {time[row]:.9g} s); {GAPS_HINT}"
        )
    if (steps - rounding > longest).any():
        long = steps - rounding > longest
        row, number = int(np.argmax(long)), int(long.sum())
        # a longer period mends rows that are uneven all along, and loses what the others tell where a few are missing
        everywhere = number > UNEVEN * len(steps) and steps.max() < FARTHEST_STEP * usual
        uneven = (
            f", or, as the rows are uneven all along, say in the map resample_s: {float(steps.max()) / LONGEST_STEP:.3g}"
            if everywhere
            else ""
        )
        more = f", the first of {number}" if number > 1 else ""
        raise UsageError(
            f"{where}: gap of {span(steps[row])} after row {row + 1} (time {time[row]:.9g} s){more}, where rows are {span(usual)} "
            f"apart; import what is before and after it as tests of their own{uneven}"
        )
    return usual


def _lost_words(lost: np.ndarray) -> str:
    number = int(lost.sum())
    return f"{counted(number, 'row is', 'rows are')} lost of {len(lost) + 1 + number}, at most {lost.max()} in a row"


def uneven_words(time: np.ndarray, period: float) -> str:
    """Say how far rows are apart that are uneven beyond the ticks of their stamps; empty where they are even."""
    if (lost := lost_rows(time)) is not None:
        return f"{_lost_words(lost)}; what lies between rows is on a line, or held"
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
    """Return the period of the log, s: what the map gives, else the mean time between rows, lost ones among them."""
    lost = lost_rows(time)
    mean = float(time[-1] - time[0]) / (len(time) - 1 + (0 if lost is None else int(lost.sum())))
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
        raise UsageError(
            f"{where}: {span(time[-1] - time[0])} of rows are no two samples {span(period)} apart: resample_s is too long"
        )
    clock = np.arange(begin, end + 1) * period
    before = np.searchsorted(time, clock + tolerance * period, side="right") - 1
    resampled = {"time_s": clock}
    for name, values in columns.items():
        if name in held or name == "phase":
            resampled[name] = values[np.clip(before, 0, rows - 1)]
        elif name != "time_s":
            resampled[name] = np.interp(clock, time, values)
    return resampled
