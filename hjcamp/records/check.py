"""What makes columns a usable test log; each fault has its own one-line message."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from hjcamp.errors import UsageError, nearest
from hjcamp.records.log import COMMAND_PHASE, ONE_OF, PHASES, REQUIRED, SAMPLE_S

RATE_TOLERANCE = 0.01
LONGEST_STEP = 1.5 * SAMPLE_S  # two samples further apart than this have lost one between them
# What one sample of 1 ms is where time_s is written in another unit.
OTHER_CLOCKS = {"ms in time_s: 1000 times too large": 1.0, "us in time_s: 1e6 times too large": 1e3}


def check_log(columns: Mapping[str, np.ndarray], where: str) -> None:
    """Raise UsageError unless ``columns``, each of shape (samples,), are a whole test log of 1 ms samples."""
    check_names(columns, where)
    check_finite(columns, where)
    check_time(columns["time_s"], where)
    check_phase(columns, where)


def check_names(names: Collection[str], where: str) -> None:
    """Raise UsageError where a required field is missing, or both of the pump's."""
    for name in REQUIRED:
        if name not in names:
            match = nearest(name, [other for other in names if other not in REQUIRED])
            hint = f" (nearest: '{match}')" if match else ""
            raise UsageError(f"{where}: required field '{name}' is missing{hint}; found: {', '.join(names) or 'none'}")
    if not any(name in names for name in ONE_OF):
        raise UsageError(f"{where}: neither 'pump_deg' nor 'command_deg' is there; a test log needs one of them")


def check_finite(columns: Mapping[str, np.ndarray], where: str) -> None:
    """Raise UsageError at the first value that is not a finite number."""
    for name, values in columns.items():
        finite = np.isfinite(values)
        if not finite.all():
            first = int(np.argmin(finite))
            raise UsageError(
                f"{where}: '{name}' is {values[first]} at sample {first}{_at(columns, first)} "
                f"({len(values) - int(finite.sum())} of {len(values)} values are not finite)"
            )


def check_time(time: np.ndarray, where: str) -> None:
    """Raise UsageError unless time (s) increases by 1 ms within 1 %, without a gap."""
    if len(time) < 2:
        return
    steps = np.diff(time)
    if (steps <= 0).any():
        first = int(np.argmax(steps <= 0)) + 1
        raise UsageError(
            f"{where}: time does not increase at sample {first}: {time[first - 1]:.6g} s, then {time[first]:.6g} s"
        )
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > LONGEST_STEP)
    if abs(usual / SAMPLE_S - 1) > RATE_TOLERANCE:
        looks = next((f"; looks like {unit}" for unit, size in OTHER_CLOCKS.items() if _near(usual, size)), "")
        raise UsageError(
            f"{where}: wrong rate, samples are {usual * 1e3:.4g} ms apart; a test log has one each 1 ms "
            f"(hjcamp import resamples){looks}"
        )
    if len(gaps):
        first = int(gaps[0])
        lost = int(np.rint(steps[gaps] / SAMPLE_S - 1).sum())
        raise UsageError(
            f"{where}: gap of {steps[first] * 1e3:.4g} ms after sample {first} (time {time[first]:.6g} s); "
            f"{lost} samples are missing in {len(gaps)} gaps"
        )
    mean = float(time[-1] - time[0]) / (len(time) - 1)
    if abs(mean / SAMPLE_S - 1) > RATE_TOLERANCE:
        raise UsageError(f"{where}: wrong rate, {mean * 1e3:.4g} ms a sample on average instead of 1 ms within 1 %")


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
