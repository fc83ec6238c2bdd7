"""Find runs by what they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.campaign.files.dotted_paths import look_up
from hjcamp.campaign.files.lock import is_locked
from hjcamp.campaign.files.run_folder import open_folder
from hjcamp.errors import UsageError
from hjcamp.records.find import tell
from hjcamp.records.plan import Plan
from hjcamp.storage import shown_path

FOLDERS = (Path("runs"), Path("multirun"))


@dataclass(frozen=True)
class FoundRun:
    """One run folder in short."""

    path: Path
    plan: Plan
    manifest: dict[str, Any]

    @property
    def state(self) -> str:
        """complete, failed, interrupted, new; running only where a process is at work."""
        state = str(self.manifest["state"])
        return "interrupted" if state == "running" and not is_locked(self.path) else state

    @property
    def done(self) -> int:
        """Number of tests that are done."""
        return sum(entry["state"] == "done" for entry in self.manifest["tests"].values())

    @property
    def started(self) -> str:
        """Time of the first session, empty before it."""
        sessions = self.manifest["sessions"]
        return str(sessions[0]["started_at"]) if sessions else ""


def find_runs(
    folders: Sequence[Path] = FOLDERS, filters: Sequence[str] = (), say: Callable[[str], None] = tell
) -> list[FoundRun]:
    """Return the runs under ``folders`` that meet every ``key=value``, newest first.

    A key is ``campaign``, ``state``, a group (``payload``), a parameter (``controller.positive.kp``), or a key of the
    provenance (``git``, ``host``). A condition that meets it is enough. ``say`` hears of run folders that cannot be read.
    """
    wanted = [_split(text) for text in filters]
    runs = []
    for place in folders:
        for file in sorted(place.glob("**/plan.json")) if place.is_dir() else []:
            try:
                folder = open_folder(file.parent)
            except UsageError as error:
                say(str(error))
                continue
            found = FoundRun(folder.path, folder.plan, folder.manifest)
            if all(_meets(found, key, value) for key, value in wanted):
                runs.append(found)
    return sorted(runs, key=lambda run: (run.started, str(run.path)), reverse=True)


def _split(text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not equals or not key:
        raise UsageError(f"'{shown_path(Path(text))}' is no folder and no filter; write KEY=VALUE, such as payload=brass_8p5g")
    return key, value


def _meets(run: FoundRun, key: str, value: str) -> bool:
    if key == "state":
        return run.state == value
    session: Mapping[str, Any] = (run.manifest["sessions"] or [{}])[-1]
    for holder in (vars(run.plan), session):
        if key in holder and not isinstance(holder[key], dict | list | tuple):
            return _same(holder[key], value)
    return any(_same(one.choices.get(key), value) or _same(look_up(one.config, key), value) for one in run.plan.conditions)


def _same(there: Any, wanted: str) -> bool:
    if there is None:
        return wanted in ("null", "none")
    if isinstance(there, int | float) and not isinstance(there, bool):
        try:
            return float(wanted) == float(there)
        except ValueError:
            return False
    return str(there).lower() == wanted.lower() or (len(wanted) >= 7 and str(there).startswith(wanted))
