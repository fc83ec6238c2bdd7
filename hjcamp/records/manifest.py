"""The manifest of a run folder: the state of each test and what made it; a report on the logs, which decide."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from hjcamp.errors import UsageError
from hjcamp.records.json_file import read_json_file
from hjcamp.records.plan import Plan

SCHEMA = "hjcamp.manifest/1"
NAME = "manifest.json"


@dataclass(frozen=True)
class _Session:
    started_at: str
    version: str
    ended_at: str | None = None
    workers: int | None = None
    host: str | None = None
    git: str | None = None
    git_changes_sha256: str | None = None


@dataclass(frozen=True)
class _TestState:
    state: Literal["planned", "done", "failed"]
    message: str = ""


@dataclass(frozen=True)
class _Manifest:
    campaign: str
    plan_sha256: str
    state: Literal["new", "running", "complete", "failed", "interrupted"]
    sessions: list[_Session]
    tests: dict[str, _TestState]


def new_manifest(plan: Plan) -> dict[str, Any]:
    """Return the manifest of a run that has not begun."""
    return {
        "schema": SCHEMA,
        "campaign": plan.campaign,
        "plan_sha256": plan.sha256,
        "state": "new",
        "sessions": [],
        "tests": {test.id: {"state": "planned"} for test in plan.tests},
    }


def read_manifest(file: Path, plan: Plan) -> dict[str, Any]:
    """Return the manifest of a plan, a new one where there is none; raises ``UsageError`` where it was changed."""
    if not file.exists():
        return new_manifest(plan)
    try:
        content: dict[str, Any] = read_json_file(file, _Manifest, SCHEMA)[0]
        if content["plan_sha256"] != plan.sha256:
            raise UsageError(f"{file}: plan_sha256 is not that of the plan next to it")
        planned = {test.id for test in plan.tests}
        if other := sorted(planned ^ set(content["tests"])):
            raise UsageError(f"{file}: tests are not those of the plan next to it: {', '.join(other[:3])}")
    except UsageError as error:
        raise UsageError(f"{error}. Delete the file, and it is made again from the logs") from error
    return content
