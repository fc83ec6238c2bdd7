"""The repetitions of one condition as few points: mean and range over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

MOST_POINTS = 400
SIGNALS = (
    "reference_deg",
    "arm_deg",
    "error_deg",
    "pressure1_mpa",
    "pressure2_mpa",
    "command_deg",
    "pid_deg",
    "feedforward_deg",
    "pump_deg",
)


@dataclass(frozen=True)
class Spread:
    """One signal of a condition: mean, lowest and highest of all repetitions, at the times of its parent."""

    mean: NDArray[np.float64]
    lowest: NDArray[np.float64]
    highest: NDArray[np.float64]


@dataclass(frozen=True)
class Condition:
    """The command phases of the repetitions of one condition, on common times (s)."""

    name: str
    tests: int
    time: NDArray[np.float64]
    signals: Mapping[str, Spread]


def gather(name: str, logs: Sequence[TestLog], most_points: int = MOST_POINTS) -> Condition:
    """Return mean and range of every signal over the repetitions, in at most ``most_points`` stretches of time.

    Peaks survive: each stretch keeps the lowest and highest sample of all repetitions. Repetitions of different length
    are compared up to the end of the shortest, those without a command phase are left out; a signal counts where every
    repetition has it.
    """
    phases = [with_error(phase) for phase in (log.command_phase for log in logs) if len(phase["time_s"])]
    samples = min((len(phase["time_s"]) for phase in phases), default=0)
    size = max(1, -(-samples // most_points))
    time = _stretches(phases[0]["time_s"][:samples], size).mean(axis=-1) if samples else np.empty(0)
    signals: dict[str, Spread] = {}
    for signal in SIGNALS if samples else ():
        if all(signal in phase for phase in phases):
            values = np.stack([_stretches(phase[signal][:samples], size) for phase in phases])
            signals[signal] = Spread(values.mean(axis=(0, 2)), values.min(axis=(0, 2)), values.max(axis=(0, 2)))
    return Condition(name, len(phases), time, signals)


def with_error(phase: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Return the columns with ``error_deg`` = reference - arm added, where there is a reference."""
    error = {"error_deg": phase["reference_deg"] - phase["arm_deg"]} if "reference_deg" in phase else {}
    return {**phase, **error}


def _stretches(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Return ``values`` as rows of ``size`` samples; the last sample fills up the last row."""
    short = -len(values) % size
    filled = np.concatenate([values, np.full(short, values[-1])]) if short else values
    return filled.reshape(-1, size)
