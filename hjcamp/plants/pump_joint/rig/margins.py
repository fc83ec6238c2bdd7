"""The limits of a rig as quantities of its log, for who looks on: the loop's own check is `rig_limits.LimitCheck`."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from hjcamp.controllers import find_controller
from hjcamp.model.checks.watch import Term, Watch
from hjcamp.plants.pump_joint.rig.limits import COMMAND_PHASE, PERIOD, REST_PHASE, SPEED_SAMPLES, read_limits

#: Of samples that were missed the log holds copies; how many is counted beside it.
MISSED = "missed_samples"


def rig_watches(config: Mapping[str, Any]) -> list[Watch]:
    """Return the limits of ``config["rig"]`` that a log can show, each as `LimitCheck` looks at it.

    Left out are those on time (a read that is late, an output that is clipped) and on silence, which no single number shows.
    """
    limits = read_limits(config)
    travel = config["pump"]["lead_mm_per_rev"] / 360.0
    rate = 1.0 / (SPEED_SAMPLES * PERIOD)
    tracked = find_controller(config["controller"]["name"]).uses_arm
    wanted = [Term("reference_deg", 1.0, 1)] if tracked else []
    before = COMMAND_PHASE if tracked else REST_PHASE
    low, high = limits.pressure_low_mpa, limits.pressure_high_mpa
    found = [
        Watch("pressure1_mpa", "MPa", (Term("pressure1_mpa"),), low, high),
        Watch("pressure2_mpa", "MPa", (Term("pressure2_mpa"),), low, high),
        Watch(
            "pressure_sum_low_mpa",
            "MPa",
            (Term("pressure1_mpa"), Term("pressure2_mpa")),
            limits.pressure_sum_low_mpa,
            phases=(REST_PHASE, COMMAND_PHASE),
        ),
        _both("arm_deg", "deg", (Term("arm_deg"),), limits.arm_deg),
        _both("arm_speed_deg_per_s", "deg/s", _change("arm_deg", rate), limits.arm_speed_deg_per_s),
        _both("tracking_deg", "deg", (*wanted, Term("arm_deg", -1.0)), limits.tracking_deg, before),
        _both("pump_travel_mm", "mm", (Term("pump_deg", travel),), limits.pump_travel_mm),
        _both("pump_speed_mm_per_s", "mm/s", _change("pump_deg", travel * rate), limits.pump_speed_mm_per_s),
        _both("pump_following_deg", "deg", (Term("command_deg", 1.0, 1), Term("pump_deg", -1.0)), limits.pump_following_deg),
        Watch("missed_in_all", "samples", (Term(MISSED),), None, limits.missed_in_all),
    ]
    return [one for one in found if any(end is not None and isfinite(end) for end in (one.low, one.high))]


def _both(name: str, unit: str, terms: tuple[Term, ...], limit: float, last: float = float("inf")) -> Watch:
    return Watch(name, unit, terms, -limit, limit, (float("-inf"), last))


def _change(column: str, factor: float) -> tuple[Term, ...]:
    return Term(column, factor), Term(column, -factor, SPEED_SAMPLES)
