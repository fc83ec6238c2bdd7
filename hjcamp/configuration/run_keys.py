"""What a run is asked for besides its conditions: how often, with which seed, on how many processes, and when to stop."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hjcamp.schema import Group, between, checked

LARGEST = 2**63 - 1
MOST_PROCESSES = 1024
Word = str | int


class RunKeys(Group):
    """The keys of the run, as they stand at the top of the configuration."""

    repetitions: int = between(1, LARGEST)  # what is made of it is held by most_tests
    seed: int = between(0, LARGEST)
    tables: str | list[str] | None = None
    conditions: Word | list[Word] | None = None
    workers: int | None = between(1, MOST_PROCESSES, default=None)
    cluster: str | None = None
    run_dir: Word | None = None
    fail_fast: bool = False
    keep_going: bool = False
    objective: Word | float | list[Word | float] | None = None  # read by campaign/plan/objective.py
    most_tests: int = between(1, LARGEST, default=100_000)


def read_run_keys(config: Mapping[str, Any]) -> RunKeys:
    """Return the keys of the run; raises ``UsageError`` for a value that is none of those allowed."""
    return checked(RunKeys, {key: config[key] for key in RunKeys.model_fields if key in config}, "")
