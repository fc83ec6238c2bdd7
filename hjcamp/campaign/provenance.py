"""What made a run: program and package versions, git commit and the changes on top of it, host."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import subprocess
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import hjcamp
from hjcamp.model.user_folders import extension_folders

PACKAGES = ("hydra-core", "mcap", "numba", "numpy", "polars", "protobuf", "scipy")


@cache
def provenance() -> dict[str, Any]:
    """Return commit, hash of uncommitted changes (None where clean), versions, host and user."""
    return {
        "version": hjcamp.__version__,
        **git_state(Path(hjcamp.__file__).resolve().parent.parent),
        "own_code_sha256": own_code_sha256(),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "host": platform.node(),
        "system": f"{platform.system()} {platform.machine()}",
        "process": os.getpid(),
    }


def code_identity() -> dict[str, Any]:
    """Return the part of the provenance that decides results: version, commit, changes, the user's own code."""
    return {key: provenance()[key] for key in ("version", "git", "git_changes_sha256", "own_code_sha256")}


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
    new_files = [folder / name for name in (untracked or "").splitlines()]
    digest = files_sha256(new_files, changes or "") if (changes or "").strip() or new_files else None
    return {"git": commit.strip() if commit else None, "git_changes_sha256": digest}


def files_sha256(files: Iterable[Path], text: str = "") -> str:
    """Return the hash of ``text`` and of the names and contents of some files; one that cannot be read has none."""
    digest = hashlib.sha256(text.encode())
    for file in files:
        digest.update(file.name.encode())
        with contextlib.suppress(OSError):
            digest.update(file.read_bytes())
    return digest.hexdigest()


def own_code_sha256() -> str | None:
    """Return the hash of the user's own effects, controllers and trajectories, None where there are none."""
    folders = [folder for name in ("effects", "controllers", "trajectories") for folder in extension_folders(name)]
    files = [file for folder in folders for file in sorted(folder.glob("*.py"))]
    return files_sha256(files) if files else None


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
