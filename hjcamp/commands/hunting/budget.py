"""The budget of a hunt: seconds of a rig at work."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import Any

from hjcamp.backends.plant_simulation import plant_in
from hjcamp.backends.schedule import phases_of
from hjcamp.errors import UsageError, shown

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
LONGEST_S = 30 * 24 * 3600.0


def seconds_of(text: str) -> float:
    """Return the seconds of ``90s``, ``30min`` or ``1.5h``; raises ``UsageError`` for anything else."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(s|min|h)\s*", text)
    seconds = float(found[1]) * UNITS[found[2]] if found else math.nan
    if not 0.0 < seconds <= LONGEST_S:
        raise UsageError(
            f"--budget {shown(text)}: give the time of the rig with its unit, such as 90s, 30min or 2h; at most 30 days"
        )
    return seconds


def planned_seconds(config: Mapping[str, Any], motion_s: float) -> float:
    """Return how long one test takes: its motion, and the rests before and after it where its procedure has them."""
    procedure = config.get("procedure") or {}
    rests = 1e-3 * sum(float(procedure.get(key) or 0.0) for key in ("rest_ms", "after_ms"))
    phases = chain(*phases_of(config, plant_in(config))) if config.get("plant") else ()
    return motion_s + rests + sum(one.seconds for one in phases)


def made_seconds(run: Path) -> float:
    """Return how long the tests of a run took, by their logs."""
    from hjcamp.records.find import find_logs
    from hjcamp.records.read import read_log

    times = [read_log(path).columns["time_s"] for path in find_logs([run])]
    return float(sum(one[-1] - one[0] for one in times if len(one)))
