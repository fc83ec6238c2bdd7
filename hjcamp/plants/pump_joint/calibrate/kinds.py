"""Which identification a log can serve: what its metadata say, else what its samples show."""

from __future__ import annotations

import numpy as np

from hjcamp.plants.pump_joint.calibrate.strokes import find_strokes
from hjcamp.records.log import TestLog

KINDS = ("pump_step", "compliance", "leakage", "friction", "open_loop_validation")
STEP_DEG = 90.0  # a pump that travels this far ...
STEP_SAMPLES = 20  # ... on a command that is at its last value within 20 ms makes a step
STEP_SHARE = 0.02
STILL_DEG = 1.1  # three counts of the arm encoder
PUMP_STILL_DEG = 2.0
LEAK_SAMPLES = 3000
SHORTEST_TEST = 50


def kind_of(log: TestLog) -> str | None:
    """Return the kind of test in ``log``, None where it serves none of the identifications."""
    campaign = log.metadata.get("campaign")
    return campaign if campaign in KINDS else kind_from_samples(log)


def kind_from_samples(log: TestLog) -> str | None:
    """Return the kind that motion of pump and arm show, whatever the metadata say.

    A step of the pump; a pump that moves while the arm stays (compliance); neither moving for 3 s (leakage); the arm
    moving while the pump does strokes at constant speed (friction).
    """
    columns = log.command_phase
    pump = columns.get("pump_deg", columns.get("command_deg"))
    if pump is None or len(pump) < SHORTEST_TEST:
        return None
    travel = float(np.ptp(pump))
    arm_stays = float(np.ptp(columns["arm_deg"])) <= STILL_DEG
    if travel <= PUMP_STILL_DEG:
        return "leakage" if arm_stays and len(pump) >= LEAK_SAMPLES else None
    strokes = has_straight_strokes(pump)
    if travel > STEP_DEG and "pump_deg" in columns and is_step(pump, columns.get("command_deg"), travel, strokes):
        return "pump_step"
    if arm_stays:
        return "compliance"
    return "friction" if strokes else None


def is_step(pump: np.ndarray, command: np.ndarray | None, travel: float, strokes: bool) -> bool:
    """Return whether the command is at its last value from the start, or, without one, the pump soon settles."""
    near = STEP_SHARE * travel
    if command is not None:
        return bool(np.all(np.abs(command[STEP_SAMPLES:] - command[-1]) <= near)) and abs(pump[0] - pump[-1]) > near
    settled = np.abs(pump[len(pump) // 2 :] - np.median(pump[-20:])) <= near
    return not strokes and bool(settled.all()) and abs(pump[0] - pump[-1]) > 0.5 * travel


def has_straight_strokes(pump: np.ndarray) -> bool:
    """Return whether the pump makes a good part of its way at constant speed."""
    covered = sum(abs(float(pump[one.stop - 1] - pump[one.start])) for one in find_strokes(pump))
    way = float(np.sum(np.abs(np.diff(pump[:: max(len(pump) // 200, 1)]))))
    return covered >= 0.3 * way
