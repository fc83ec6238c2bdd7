"""What makes columns a usable test log; each fault has its own one-line message."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from hjcamp.errors import UsageError, counted, nearest
from hjcamp.model.language.field_table import FieldTable
from hjcamp.records.log import COMMAND_PHASE, PHASES, TestLog
from hjcamp.records.of_plant import PERIOD_KEY, span

RATE_TOLERANCE = 0.01
LONGEST_STEP = 1.5  # periods: two samples further apart than this have lost one between them
# How much longer a sample seems where time_s is written in another unit.
OTHER_CLOCKS = {"ms in time_s: 1000 times too large": 1e3, "us in time_s: 1e6 times too large": 1e6}


def check_log(log: TestLog, where: str) -> None:
    """Raise UsageError unless the columns of a log, each of shape (samples,), are a whole test of its plant, evenly sampled."""
    check_names(log.columns, log.table, where)
    check_finite(log.columns, where)
    check_time(log.columns["time_s"], log.period, where, PERIOD_KEY in log.metadata)
    check_phase(log.columns, where)


def check_names(names: Collection[str], table: FieldTable, where: str) -> None:
    """Raise UsageError where a required field is missing, or all of those that a log needs one of."""
    for name in table.required:
        if name not in names:
            match = nearest(name, [other for other in names if other not in table.required])
            hint = f" (nearest: '{match}')" if match else ""
            raise UsageError(f"{where}: required field '{name}' is missing{hint}; found: {', '.join(names) or 'none'}")
    if table.one_of and not any(name in names for name in table.one_of):
        neither = " nor ".join(f"'{name}'" for name in table.one_of)
        raise UsageError(f"{where}: neither {neither} is there; a test log needs one of them")


def check_finite(columns: Mapping[str, np.ndarray], where: str, hint: str = "") -> None:
    """Raise UsageError at the first value that is not a finite number, with a ``hint`` for one that is not known."""
    for name, values in columns.items():
        finite = np.isfinite(values)
        if not finite.all():
            first = int(np.argmin(finite))
            raise UsageError(
                f"{where}: '{name}' is {values[first]} at sample {first}{_at(columns, first)} "
                f"({len(values) - int(finite.sum())} of {len(values)} values are not finite){hint if np.isnan(values[first]) else ''}"
            )


def check_time(time: np.ndarray, period: float, where: str, said: bool = False) -> None:
    """Raise UsageError unless time (s) increases by ``period`` within 1 %, without a gap; ``said`` by the metadata or not."""
    if len(time) < 2:
        return
    steps = np.diff(time)
    if (steps <= 0).any():
        first = int(np.argmax(steps <= 0)) + 1
        raise UsageError(
            f"{where}: time does not increase at sample {first}: {time[first - 1]:.6g} s, then {time[first]:.6g} s"
        )
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > LONGEST_STEP * period)
    if abs(usual / period - 1) > RATE_TOLERANCE:
        looks = next((f"; looks like {unit}" for unit, size in OTHER_CLOCKS.items() if _near(usual, size * period)), "")
        by = f"by {PERIOD_KEY} of its metadata it has" if said else "a test log has"
        raise UsageError(
            f"{where}: wrong rate, samples are {span(usual)} apart; {by} one each {span(period)} "
            f"(hjcamp import resamples){looks}"
        )
    if len(gaps):
        first = int(gaps[0])
        lost = int(np.rint(steps[gaps] / period - 1).sum())
        raise UsageError(
            f"{where}: gap of {span(steps[first])} after sample {first} (time {time[first]:.6g} s); "
            f"{counted(lost, 'sample is', 'samples are')} missing in {counted(len(gaps), 'gap')}"
        )
    mean = float(time[-1] - time[0]) / (len(time) - 1)
    if abs(mean / period - 1) > RATE_TOLERANCE:
        raise UsageError(f"{where}: wrong rate, {span(mean)} a sample on average instead of {span(period)} within 1 %")


def check_phase(columns: Mapping[str, np.ndarray], where: str) -> None:
    """Raise UsageError at a phase that does not exist, or where the command phase is missing."""
    if "phase" not in columns:
        return
    phase = columns["phase"]
    known = np.isin(phase, list(PHASES))
    if not known.all():
        first = int(np.argmin(known))
        allowed = ", ".join(f"{number} {name}" for number, name in PHASES.items())
        raise UsageError(f"{where}: phase {phase[first]:g} at sample {first}{_at(columns, first)}; allowed: {allowed}")
    if not (phase == COMMAND_PHASE).any():
        raise UsageError(f"{where}: no sample of the command phase (phase 3), so there is nothing to analyse")


def _near(step: float, size: float) -> bool:
    return abs(step / size - 1) <= RATE_TOLERANCE


def _at(columns: Mapping[str, np.ndarray], sample: int) -> str:
    time = columns.get("time_s")
    return f" (time {time[sample]:.6g} s)" if time is not None and np.isfinite(time[sample]) else ""
