"""The plan of a run: every condition with its resolved configuration, every test with its seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from hjcamp.errors import UsageError

SCHEMA = "hjcamp.plan/1"


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

    @classmethod
    def from_json(cls, content: Mapping[str, Any], where: str) -> Plan:
        """Return the plan in ``plan.json``; raises ``UsageError`` where it is not one of ours."""
        if content.get("schema") != SCHEMA:
            raise UsageError(f"{where} has schema {content.get('schema')!r}; this version reads {SCHEMA}")
        try:
            values = {key: value for key, value in content.items() if key != "schema"}
            values["tables"] = tuple(values["tables"])
            values["conditions"] = tuple(Condition(**entry) for entry in values["conditions"])
            values["tests"] = tuple(PlannedTest(**entry) for entry in values["tests"])
            return cls(**values)
        except (KeyError, TypeError) as error:
            raise UsageError(f"{where} is incomplete: {error}") from error
