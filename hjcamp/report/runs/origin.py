"""What a run folder and its logs say about their origin."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError
from hjcamp.records.manifest import read_manifest
from hjcamp.records.plan import NAME as PLAN
from hjcamp.records.plan import read_plan
from hjcamp.storage import check_is_file
from hjcamp.yaml_file import yaml_values

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

FROM_METADATA = ("campaign", "model", "backend", "version", "git", "started_at", "config_sha256")


@dataclass(frozen=True)
class RunOrigin:
    """The plan, manifest and configuration of a run folder; all empty for a mere folder of logs."""

    plan: dict[str, Any] = field(default_factory=dict)
    manifest: dict[str, Any] = field(default_factory=dict)
    config_text: str = ""
    config: dict[str, Any] = field(default_factory=dict)

    @property
    def tables(self) -> list[str] | None:
        """The tables that the campaign asks for; None where there is no plan."""
        tables = self.plan.get("tables")
        return [str(name) for name in tables] if isinstance(tables, list | tuple) else None

    @property
    def condition_order(self) -> list[str]:
        """The names of the conditions in the order of the plan."""
        conditions = self.plan.get("conditions")
        return [str(one.get("name")) for one in conditions] if isinstance(conditions, list | tuple) else []

    @property
    def axes(self) -> dict[str, list[str]]:
        """The axes of the plan with their labels; empty where there is no plan."""
        axes = self.plan.get("axes")
        pairs = axes.items() if isinstance(axes, dict) else ()
        return {str(name): [str(label) for label in labels] for name, labels in pairs if isinstance(labels, list)}

    @property
    def command(self) -> str:
        """The command that runs the same campaign again; empty where the folder does not tell."""
        campaign = self.plan.get("campaign") or self.manifest.get("campaign")
        if not campaign:
            return ""
        overrides = self.config.get("overrides")
        words = [str(word) for word in overrides] if isinstance(overrides, list) else []
        words = [word for word in words if not word.startswith(("campaign=", "run_dir="))]
        return " ".join(shlex.quote(word) for word in ["hjcamp", "run", f"campaign={campaign}", *words])


def read_origin(run_dir: Path) -> RunOrigin:
    """Return what the files of a run folder say, empty for a mere folder of logs.

    Raises ``UsageError`` where ``plan.json`` or ``manifest.json`` cannot be read or was changed.
    """
    config_text = _text(run_dir / "config.yaml")
    try:
        config = yaml_values(config_text)
    except UsageError:
        config = None
    plan = read_plan(run_dir / PLAN) if (run_dir / PLAN).exists() else None
    return RunOrigin(
        plan=plan.as_json() if plan else {},
        manifest=read_manifest(run_dir / "manifest.json", plan) if plan else {},
        config_text=config_text,
        config=config if isinstance(config, dict) else {},
    )


def origin_facts(origin: RunOrigin, logs: Sequence[TestLog]) -> list[tuple[str, str]]:
    """Return what made this run as (name, value) pairs for a reader."""
    facts = [(name, ", ".join(sorted({log.metadata[name] for log in logs if name in log.metadata}))) for name in FROM_METADATA]
    facts = [(name, _shortened(value)) for name, value in facts if value]
    for key in ("repetitions", "seed", "sha256"):
        if key in origin.plan:
            facts.append((f"plan {key}", str(origin.plan[key])))
    sessions = origin.manifest.get("sessions")
    last = sessions[-1] if isinstance(sessions, list) and sessions and isinstance(sessions[-1], dict) else {}
    for key in ("started_at", "ended_at", "workers", "git", "git_changes_sha256", "python", "system", "host"):
        if last.get(key) is not None:
            facts.append((f"session {key}", str(last[key])))
    packages = last.get("packages")
    if isinstance(packages, dict):
        facts.append(("packages", ", ".join(f"{name} {version}" for name, version in packages.items())))
    return facts


def states_of_tests(origin: RunOrigin) -> dict[str, int]:
    """Return how many tests of the manifest are in each state."""
    tests = origin.manifest.get("tests")
    counts: dict[str, int] = {}
    for entry in tests.values() if isinstance(tests, dict) else ():
        state = str(entry.get("state")) if isinstance(entry, dict) else "unknown"
        counts[state] = counts.get(state, 0) + 1
    return counts


def _shortened(value: str, longest: int = 200) -> str:
    return value if len(value) <= longest else value[:longest] + " …"


def _text(path: Path) -> str:
    try:
        check_is_file(path)
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
