"""Where a stopped test leaves pump motor and arm."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LeftAt:
    """Where a stopped test left pump motor and arm, rad: a task opened later starts its counters there."""

    motor: float
    arm: float
