"""The plan of a run: every condition with its resolved configuration, every test with its seed; verified when read."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, counted
from hjcamp.records.json_file import read_json_file
from hjcamp.storage import values_spelled

SCHEMA = "hjcamp.plan/1"
NAME = "plan.json"
# A condition's name makes a folder's name: never a way to another place.
SAFE_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._=-]*")
OF_THE_RUN = ("repetitions", "seed")
SHOWN_DIGITS = 12


@dataclass(frozen=True)
class Condition:
    """One set of choices and parameters: ``config`` is the resolved configuration, ``duration`` the motion in s."""

    name: str
    choices: dict[str, str]
    config: dict[str, Any]
    duration: float
    sha256: str


@dataclass(frozen=True)
class PlannedTest:
    """One repetition of one condition; ``log`` is its path inside the run folder."""

    id: str
    condition: str
    repetition: int
    seed: int
    log: str


@dataclass(frozen=True)
class Plan:
    """Everything a run will do, known before it starts. Its ``sha256`` covers all that decides the results."""

    campaign: str
    description: str
    tables: tuple[str, ...]
    repetitions: int
    seed: int
    fixed: dict[str, Any]
    axes: dict[str, list[str]]
    conditions: tuple[Condition, ...]
    tests: tuple[PlannedTest, ...]
    sha256: str

    @property
    def duration(self) -> float:
        """Time of motion of all tests, s."""
        return sum(condition.duration for condition in self.conditions) * self.repetitions

    def condition(self, name: str) -> Condition:
        """Return the condition of that name."""
        return next(condition for condition in self.conditions if condition.name == name)

    def as_json(self) -> dict[str, Any]:
        """Return the content of ``plan.json``."""
        return {"schema": SCHEMA, **asdict(self)}


def read_plan(file: Path) -> Plan:
    """Return the plan in ``plan.json``.

    Hashes, seeds and paths are computed again; raises ``UsageError`` where the file is none of ours or was changed.
    """
    plan: Plan = read_json_file(file, Plan, SCHEMA)[1]
    problem = _shape_problem(plan) or _hash_problem(plan) or _test_problem(plan)
    if problem:
        raise UsageError(f"{file}: {problem}")
    return plan


def folder_name(condition: str) -> str:
    """Return the name of a condition's folder: ``kp=-0.7`` is in ``kpm0p7``; a name without a value is its own."""
    return values_spelled(condition).replace("=", "-")


def lasting_name(condition: str) -> str:
    """Return what seeds and comparisons know a condition by: ``kp-0.7``, as ``kp=0.7`` was written in earlier runs."""
    return condition.replace("=", "-")


def planned_tests(conditions: Sequence[str], repetitions: int, seed: int) -> tuple[PlannedTest, ...]:
    """Return the tests of a run: all that they are follows from the conditions' names, the repetitions and the seed."""
    return tuple(
        PlannedTest(
            f"{name}/rep_{repetition:02d}",
            name,
            repetition,
            seed_of(seed, name, repetition),
            f"logs/{folder_name(name)}/rep_{repetition:02d}.mcap",
        )
        for name in conditions
        for repetition in range(1, repetitions + 1)
    )


def seed_of(seed: int, condition: str, repetition: int) -> int:
    """Return the seed of one test.

    It follows from the seed of the run, the condition's lasting name and the repetition, so it is the same in any order, on
    any number of workers, and when a parameter or the backend is changed: runs can be compared test by test.
    """
    import numpy as np

    name = int.from_bytes(hashlib.sha256(lasting_name(condition).encode()).digest()[:16], "big")
    return int(np.random.SeedSequence([seed, name, repetition]).generate_state(2, np.uint64)[0] >> 1)


def config_sha256(config: Mapping[str, Any]) -> str:
    """Return the hash of a condition's configuration; how often it is repeated, and with which seed, is of the run."""
    return sha256_of({key: value for key, value in config.items() if key not in OF_THE_RUN})


def plan_sha256(campaign: str, tables: Sequence[str], repetitions: int, seed: int, conditions: Sequence[Condition]) -> str:
    """Return the hash of all that decides the results of a run."""
    return sha256_of([campaign, tables, repetitions, seed, [[one.name, one.config] for one in conditions]])


def sha256_of(content: Any) -> str:
    """Return the hash of plain values, independent of the order of keys, and equal for what is read back from JSON."""
    plain = json.loads(json.dumps(content, default=str))
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


def _shape_problem(plan: Plan) -> str | None:
    if not plan.conditions:
        return "conditions is empty; a run has at least one"
    if plan.repetitions < 1 or plan.seed < 0:
        return f"repetitions is {plan.repetitions} and seed {plan.seed}; at least 1 and 0 are needed"
    seen: set[str] = set()
    for number, one in enumerate(plan.conditions):
        if not SAFE_NAME.fullmatch(one.name):
            return f"conditions[{number}].name is {one.name!r}; letters, digits and . _ - = make a name, not . or = in front"
        if folder_name(one.name).lower() in seen:
            return f"two conditions are named '{one.name}', or their folders would be"
        if not (math.isfinite(one.duration) and one.duration >= 0):
            return f"conditions[{number}].duration is {one.duration}; zero or more is needed"
        seen.add(folder_name(one.name).lower())
    return None


def _hash_problem(plan: Plan) -> str | None:
    remedy = "put the file back as it was, or run again with run_dir=DIR"
    for one in plan.conditions:
        found = config_sha256(one.config)
        if found != one.sha256:
            return (
                f"condition '{one.name}' was changed after it was planned: its configuration has the hash "
                f"{found[:SHOWN_DIGITS]}, its sha256 says {one.sha256[:SHOWN_DIGITS]}; {remedy}"
            )
    found = plan_sha256(plan.campaign, plan.tables, plan.repetitions, plan.seed, plan.conditions)
    if found != plan.sha256:
        return (
            f"campaign, tables, repetitions, seed or conditions were changed after they were planned: they have the "
            f"hash {found[:SHOWN_DIGITS]}, sha256 says {plan.sha256[:SHOWN_DIGITS]}; {remedy}"
        )
    return None


def _test_problem(plan: Plan) -> str | None:
    number, conditions = len(plan.conditions) * plan.repetitions, len(plan.conditions)
    if len(plan.tests) != number:
        return (
            f"tests holds {len(plan.tests)}; {counted(conditions, 'condition')} with "
            f"{counted(plan.repetitions, 'repetition')} {'is' if number == 1 else 'are'} {number}"
        )
    expected = planned_tests([one.name for one in plan.conditions], plan.repetitions, plan.seed)
    for place, (there, here) in enumerate(zip(plan.tests, expected, strict=True)):
        if there != here:
            key = next(key for key in asdict(here) if getattr(there, key) != getattr(here, key))
            return f"tests[{place}].{key} is {getattr(there, key)!r}; the plan gives {getattr(here, key)!r}"
    return None
