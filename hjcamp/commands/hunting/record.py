"""What is known of a hunt: its settings, its rounds, how it stands; kept in its folder, whole at every moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.campaign.files.json_files import write_json
from hjcamp.campaign.files.lock import is_locked
from hjcamp.errors import UsageError
from hjcamp.records.json_file import read_json_file
from hjcamp.storage import check_place, disk_errors

SCHEMA = "hjcamp.hunt/1"
NAME = "hunt.json"
HUNTS = Path("hunts")
#: The hunt is at work, was interrupted or stopped by its rig, or has ended with a reason.
RUNNING, INTERRUPTED, STOPPED, ENDED = "running", "interrupted", "stopped", "ended"


@dataclass
class Round:
    """One run of tests and what was concluded after it.

    ``since`` is the first round whose tests count: those before a drift of the rig do not. ``expected`` are the separations that
    `hjcamp next` gave these tests.
    """

    run: str
    tests: list[dict[str, Any]]
    repetitions: int
    seconds: float
    since: int = 0
    made: bool = False
    expected: list[dict[str, Any]] = field(default_factory=list)
    drift: list[dict[str, Any]] = field(default_factory=list)
    diagnosis: dict[str, Any] | None = None


@dataclass
class Hunt:
    """A hunt as its folder keeps it: ``hunt.json`` has all of it but the tests, which are in the runs."""

    campaign: str
    plant: str
    plan_sha256: str
    asked: dict[str, Any]
    budget_s: float
    rounds: list[Round]
    state: str = RUNNING
    reason: str = ""
    message: str = ""

    @property
    def spent_s(self) -> float:
        """How long the rig was at work, s."""
        return sum(one.seconds for one in self.rounds if one.made)

    @property
    def last(self) -> dict[str, Any] | None:
        """What was concluded last."""
        return next((one.diagnosis for one in reversed(self.rounds) if one.diagnosis), None)

    def as_json(self) -> dict[str, Any]:
        """Return the answer for programs."""
        last = self.last or {}
        found = {"schema": SCHEMA, **asdict(self), "spent_s": self.spent_s}
        return {**found, **{key: last.get(key) for key in ("verdict", "effects", "not_ruled_out", "error")}}


def save(folder: Path, hunt: Hunt) -> None:
    """Write a hunt into its folder."""
    with disk_errors(folder, "free space, then give the same call again"):
        folder.mkdir(parents=True, exist_ok=True)
        write_json(folder / NAME, hunt.as_json())


def read(folder: Path) -> Hunt:
    """Return the hunt of a folder; raises ``UsageError`` where there is none, or its file was changed."""
    found: Hunt = read_json_file(folder / NAME, Hunt, SCHEMA)[1]
    return found


def folder_of(campaign: str, plan_sha256: str, asked: Mapping[str, Any], given: Path | None) -> tuple[Path, Hunt | None]:
    """Return the folder of a hunt, and the hunt that goes on there, None where it begins.

    Without ``given`` that is the newest hunt of the same plan and settings that has not ended, else a new folder. Raises
    ``UsageError`` for a folder with something else in it.
    """
    if given is not None:
        check_place(given, "run_dir=", folder=True)
        if (given / NAME).is_file():
            found = read(given)
            if (found.plan_sha256, found.asked) != (plan_sha256, dict(asked)):
                raise UsageError(f"run_dir={given} holds a hunt with another campaign or other settings; choose another folder")
            return given, found
        if given.exists() and any(given.iterdir()):
            raise UsageError(f"run_dir={given} is there and is no hunt; choose another folder")
        return given, None
    parent = HUNTS / campaign
    for path in sorted(parent.iterdir(), reverse=True) if parent.is_dir() else ():
        try:
            found = read(path)
        except UsageError:
            continue
        if (found.plan_sha256, found.asked) == (plan_sha256, dict(asked)) and found.state != ENDED and not is_locked(path):
            return path, found
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    path, number = parent / stamp, 1
    while path.exists():
        number += 1
        path = parent / f"{stamp}_{number}"
    return path, None
