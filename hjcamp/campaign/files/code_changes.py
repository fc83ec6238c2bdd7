"""The changes on top of a commit, as text that ``git apply`` takes: kept with what was made with them."""

from __future__ import annotations

import hashlib
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

PARTS = ("hjcamp", "conf", "campaigns")  # what decides results
LARGEST_BYTES = 1_000_000
TIMEOUT_S = 10.0


@dataclass(frozen=True)
class CodeState:
    """``commit`` (None outside git) and ``changes`` on top of it, new files included (empty where clean)."""

    commit: str | None
    changes: bytes = b""

    @cached_property
    def sha256(self) -> str | None:
        """Return the hash of the changes, None where there are none."""
        return hashlib.sha256(self.changes).hexdigest() if self.changes else None

    @property
    def file_name(self) -> str | None:
        """Return the name under which the changes are kept, None where there are none or they are too large."""
        return f"changes_{(self.sha256 or '')[:12]}.diff" if 0 < len(self.changes) <= LARGEST_BYTES else None


def code_state(folder: Path) -> CodeState:
    """Return the state of a checkout; nothing is known where ``folder`` is no checkout of its own."""
    if not (folder / ".git").exists():
        return CodeState(None)
    commit = _git(folder, "rev-parse", "HEAD").decode().strip() or None
    diff = ("diff", "--no-ext-diff", "--no-textconv", "--no-color", "--binary")
    changes = _git(folder, *diff, "HEAD", "--", *PARTS)
    for name in _git(folder, "ls-files", "-z", "--others", "--exclude-standard", "--", *PARTS).split(b"\0"):
        if name:
            changes += _git(folder, *diff, "--no-index", "--", "/dev/null", name.decode(errors="surrogateescape"))
    return CodeState(commit, changes)


def _git(folder: Path, *arguments: str) -> bytes:
    try:
        answer = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, timeout=TIMEOUT_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return b""
    # Two files that differ are 1, as with diff.
    return answer.stdout if answer.returncode in (0, 1) else b""
