"""The four numbers that judge a test (thesis 5.2.5), and what its lines and its command tell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

INDICATORS = ("rmse1_deg", "rmse2_deg", "e_max_deg", "sse_deg")
#: Lowest and highest of both lines, time of either line beyond a bound, share of the feedforward (0 to 1).
FURTHER = ("pressure_low_mpa", "pressure_high_mpa", "below_0p1_s", "above_0p58_s", "above_range_s", "feedforward_share")
AIR_MPA = 0.1  # thesis 5.2.5: below, air bubbles make the lines soft
LEAK_MPA = 0.58  # thesis 4.4.4: above, the fittings leak
SENSOR_RANGE_MPA = 0.689  # thesis 3.9, where the log does not say
START_LEFT_OUT = 0.25
SETTLING_TIME = 0.2


def error_indicators(command: Mapping[str, Any], trajectory: str) -> dict[str, float | None]:
    r"""Return `INDICATORS` of the error e = desired - measured arm angle (deg) of the n samples of a command phase (5.2.5.1, 2).

    .. math:: RMSE1 = \sqrt{\tfrac{1}{n} \sum e_i^2}, \quad e_{max} = \max |e_i|

    RMSE2 leaves out the first 0.25 s. The steady state error is the mean of e from 0.2 s after the reference last
    changed to the end, for cycloids only; it is negative where the arm is beyond a positive reference, as in Table
    5.4.2 (5.2.5: error = desired - output). What a log cannot give is None.
    """
    values: dict[str, float | None] = dict.fromkeys(INDICATORS)
    if not {"reference_deg", "arm_deg"} <= set(command) or not len(command["time_s"]):
        return values
    time, reference = command["time_s"], command["reference_deg"]
    error = reference - command["arm_deg"]
    values["rmse1_deg"] = _root_mean_square(error)
    values["rmse2_deg"] = _root_mean_square(error[time >= START_LEFT_OUT - 1e-9])
    values["e_max_deg"] = float(np.max(np.abs(error)))
    changes = np.flatnonzero(np.diff(reference))
    if trajectory.startswith("cycloid") and changes.size:
        settled = error[time >= time[changes[-1] + 1] + SETTLING_TIME - 1e-9]
        values["sse_deg"] = float(np.mean(settled)) if settled.size else None
    return values


def _root_mean_square(error: NDArray[np.float64]) -> float | None:
    return float(np.sqrt(np.mean(error**2))) if error.size else None


def line_indicators(log: TestLog, configuration: Mapping[str, Any]) -> dict[str, float | None]:
    """Return `FURTHER` of the command phase; None for what the log does not hold.

    The share is rms(feedforward) / (rms(feedforward) + rms(feedback)) of the command's two parts.
    """
    values: dict[str, float | None] = dict.fromkeys(FURTHER)
    command = log.command_phase
    lines = [command[name] for name in ("pressure1_mpa", "pressure2_mpa") if name in command]
    if len(lines) == 2 and len(lines[0]) > 1:
        low, high = np.minimum(*lines), np.maximum(*lines)
        period = float(np.median(np.diff(command["time_s"])))
        sensors = (configuration.get("rig") or {}).get("sensors") or {}
        end = float(sensors.get("pressure_range_mpa") or SENSOR_RANGE_MPA)
        values |= {
            "pressure_low_mpa": float(low.min()),
            "pressure_high_mpa": float(high.max()),
            "below_0p1_s": period * int(np.sum(low < AIR_MPA)),
            "above_0p58_s": period * int(np.sum(high > LEAK_MPA)),
            "above_range_s": period * int(np.sum(high > end)),
        }
    if "feedforward_deg" in command and "pid_deg" in command:
        forward, back = _rms(command["feedforward_deg"]), _rms(command["pid_deg"])
        values["feedforward_share"] = forward / (forward + back) if forward > 0.0 else None
    return values


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0
