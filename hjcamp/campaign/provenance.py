"""What made a run: program and package versions, git commit and the changes on top of it, host."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import hjcamp

PACKAGES = ("hydra-core", "mcap", "numba", "numpy", "polars", "protobuf", "scipy")


@lru_cache(maxsize=1)
def provenance() -> dict[str, Any]:
    """Return commit, hash of uncommitted changes (None where clean), versions, host and user."""
    return {
        "version": hjcamp.__version__,
        **git_state(Path(hjcamp.__file__).resolve().parent.parent),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "host": platform.node(),
        "system": f"{platform.system()} {platform.machine()}",
        "process": os.getpid(),
    }


def code_identity() -> dict[str, Any]:
    """Return the part of the provenance that decides results: version, commit, changes."""
    return {key: provenance()[key] for key in ("version", "git", "git_changes_sha256")}


def git_label() -> str:
    """Return the commit for the metadata of a log, with the hash of the changes on top; empty outside git."""
    commit, changes = provenance()["git"], provenance()["git_changes_sha256"]
    return "" if commit is None else commit if changes is None else f"{commit}+{changes[:12]}"


def git_state(folder: Path) -> dict[str, Any]:
    """Return commit and hash of the changes of a checkout; both None where ``folder`` is no checkout of its own."""
    if not (folder / ".git").exists():
        return {"git": None, "git_changes_sha256": None}
    commit = _git(folder, "rev-parse", "HEAD")
    changes = _git(folder, "diff", "HEAD", "--no-ext-diff", "--", "hjcamp", "conf", "campaigns")
    untracked = _git(folder, "ls-files", "--others", "--exclude-standard", "--", "hjcamp", "conf", "campaigns")
    dirty = (changes or "") + (untracked or "")
    digest = hashlib.sha256(dirty.encode()).hexdigest() if dirty.strip() else None
    return {"git": commit.strip() if commit else None, "git_changes_sha256": digest}


def utc_now() -> str:
    """Return the time as ``2026-11-21T09:45:12Z``."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        answer = subprocess.run(
            ["git", *arguments], cwd=folder, capture_output=True, text=True, timeout=10, check=False, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return answer.stdout if answer.returncode == 0 else None


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
