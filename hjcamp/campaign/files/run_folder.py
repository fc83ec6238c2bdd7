"""The run folder: create it, find one that waits to go on, keep the state of its tests."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import yaml

from hjcamp.campaign.files.dotted_paths import common, leaves
from hjcamp.campaign.files.json_files import run_errors, write_json
from hjcamp.campaign.files.lock import is_locked
from hjcamp.campaign.files.provenance import code, code_identity, provenance, utc_now
from hjcamp.errors import UsageError, counted
from hjcamp.records.manifest import new_manifest, read_manifest
from hjcamp.records.plan import Plan, read_plan
from hjcamp.storage import write_whole

RUNS = Path("runs")
LOG = "run.log"
SAVE_EVERY_S = 0.5


@dataclass
class RunFolder:
    """A run folder with its plan and manifest. What is finished is decided by the logs; the manifest reports it."""

    path: Path
    plan: Plan
    manifest: dict[str, Any]
    _saved: float = field(default=0.0, repr=False)

    @property
    def complete(self) -> bool:
        """Return whether every planned test is done."""
        return all(entry["state"] == "done" for entry in self.manifest["tests"].values())

    def record(self, test: str, state: str, **details: Any) -> None:
        """Note the state of a test; written at most twice a second."""
        self.manifest["tests"][test] = {"state": state, **details}
        if time.monotonic() - self._saved > SAVE_EVERY_S:
            self.save()

    def save(self) -> None:
        """Write the manifest."""
        with run_errors(self.path):
            write_json(self.path / "manifest.json", self.manifest)
        self._saved = time.monotonic()

    def note(self, text: str) -> None:
        """Add a line to ``run.log``, with the time; what cannot be written there must not end a run."""
        with suppress(OSError), (self.path / LOG).open("a", encoding="utf-8", errors="replace") as stream:
            stream.write("".join(f"{utc_now()}  {line}\n" for line in text.splitlines()))

    def begin(self, workers: int) -> None:
        """Open a session in the manifest, with what makes this run."""
        changes = self.keep_changes()
        session = {"started_at": utc_now(), "ended_at": None, "workers": workers, **provenance()}
        session["git_changes_file"] = changes
        self.manifest["sessions"].append(session)
        self.manifest["state"] = "running"
        self.save()
        left = sum(entry["state"] != "done" for entry in self.manifest["tests"].values())
        code_of = f"git {str(session['git'])[:12]}" if session.get("git") else f"version {session.get('version')}"
        self.note(
            f"session {len(self.manifest['sessions'])}: {counted(left, 'test')} to make, {counted(workers, 'worker')}, {code_of}"
        )

    def keep_changes(self) -> str | None:
        """Write the changes on top of the commit into ``provenance/``; the name holds their hash. None: none, or > 1 MB."""
        state = code()
        if state.file_name is None:
            return None
        path = self.path / "provenance" / state.file_name
        with run_errors(self.path):
            path.parent.mkdir(exist_ok=True)
            if not path.exists():
                write_whole(path, state.changes)
        return path.relative_to(self.path).as_posix()

    def note_rig(self, facts: Mapping[str, str]) -> None:
        """Note in the session what a backend said of itself: device serials, host, calibration."""
        if facts:
            # When a test began is the log's own; the session has its own beginning.
            self.manifest["sessions"][-1]["rig"] = {key: facts[key] for key in facts if key != "started_at"}

    def end(self, state: str) -> None:
        """Close the session; ``state`` is complete, failed or interrupted."""
        self.manifest["sessions"][-1]["ended_at"] = utc_now()
        self.manifest["state"] = state
        self.save()
        done = sum(entry["state"] == "done" for entry in self.manifest["tests"].values())
        self.note(f"{state}: {done} of {counted(len(self.manifest['tests']), 'test')} done")


def create(path: Path, plan: Plan, asked: Mapping[str, Any], overrides: list[str]) -> RunFolder:
    """Make a run folder: ``config.yaml`` (what runs), ``plan.json``, ``manifest.json``, empty ``logs/``."""
    runs = common([one.config for one in plan.conditions])
    text = "# What runs; what differs from condition to condition varies, and plan.json has it.\n" + yaml.safe_dump(
        {"overrides": overrides, **asked, **{key: runs[key] for key in asked if key in runs}},
        sort_keys=False,
        allow_unicode=True,
    )
    with run_errors(path):
        (path / "logs").mkdir(parents=True, exist_ok=True)
        write_whole(path / "config.yaml", text)
        folder = RunFolder(path, plan, new_manifest(plan))
        folder.save()
        # plan.json comes last: a folder is a run once it is there.
        write_json(path / "plan.json", plan.as_json())
    return folder


def open_folder(path: Path) -> RunFolder:
    """Return the run in an existing folder; raises ``UsageError`` where it is none, or its files were changed."""
    if not path.is_dir():
        raise UsageError(f"run folder {path} not found; see: hjcamp ls")
    if not (path / "plan.json").is_file():
        raise UsageError(f"{path} is not a run folder: plan.json is missing")
    plan = read_plan(path / "plan.json")
    return RunFolder(path, plan, read_manifest(path / "manifest.json", plan))


def folder_for(
    plan: Plan, asked: Mapping[str, Any], overrides: list[str], run_dir: Path | None, runs: Path = RUNS
) -> tuple[RunFolder, bool]:
    """Return the folder of a run and whether it goes on with an earlier one.

    With ``run_dir`` the folder is that one; a run of another configuration there is refused. Without it, the newest
    unfinished run of the same plan and the same code goes on, else a new folder is made.
    """
    if run_dir is not None:
        if (run_dir / "plan.json").is_file():
            folder = open_folder(run_dir)
            refuse_other_plan(folder, plan)
            return folder, True
        if run_dir.exists() and (not run_dir.is_dir() or any(run_dir.glob("logs/*"))):
            raise UsageError(f"run_dir={run_dir} is there and is not a run folder; choose another")
        return create(run_dir, plan, asked, overrides), False
    waiting = _unfinished(runs / plan.campaign, plan)
    if waiting is not None:
        return waiting, True
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    path, number = runs / plan.campaign / stamp, 1
    while path.exists():
        number += 1
        path = runs / plan.campaign / f"{stamp}_{number}"
    return create(path, plan, asked, overrides), False


def refuse_other_plan(folder: RunFolder, plan: Plan) -> None:
    """Raise ``UsageError``, with the first differences, where the folder holds another plan."""
    if folder.plan.sha256 == plan.sha256:
        return
    there, here = (dict(leaves(_comparable(one))) for one in (folder.plan, plan))
    differences = [
        f"{key}: {there.get(key, 'absent')} there, {here.get(key, 'absent')} here"
        for key in dict.fromkeys((*there, *here))
        if there.get(key) != here.get(key)
    ]
    more = f" (and {len(differences) - 3} more)" if len(differences) > 3 else ""
    raise UsageError(
        f"{folder.path} holds a run with another configuration: {'; '.join(differences[:3])}{more}. "
        "Choose another folder with run_dir=DIR"
    )


def _comparable(plan: Plan) -> dict[str, Any]:
    return {
        "campaign": plan.campaign,
        "repetitions": plan.repetitions,
        "seed": plan.seed,
        "tables": ", ".join(plan.tables),
        "conditions": ", ".join(one.name for one in plan.conditions),
        **{one.name: {k: v for k, v in one.config.items() if k not in ("repetitions", "seed")} for one in plan.conditions},
    }


def _unfinished(parent: Path, plan: Plan) -> RunFolder | None:
    if not parent.is_dir():
        return None
    for path in sorted(parent.iterdir(), reverse=True):
        try:
            folder = open_folder(path)
        except UsageError:
            continue
        if folder.plan.sha256 != plan.sha256 or folder.manifest["state"] == "complete" or is_locked(path):
            continue
        sessions = folder.manifest["sessions"]
        if not sessions or {key: sessions[-1].get(key) for key in code_identity()} == code_identity():
            return folder
    return None
