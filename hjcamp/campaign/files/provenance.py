"""What made a run: program and package versions, git commit and the changes on top of it, host."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import hjcamp
from hjcamp.campaign.files.code_changes import CodeState, code_state
from hjcamp.model.files.user_folders import extension_folders

PACKAGES = ("grpcio", "hydra-core", "mcap", "nidaqmx", "numba", "numpy", "polars", "protobuf", "scipy")


def provenance() -> dict[str, Any]:
    """Return commit, hash and size of uncommitted changes (None where clean), the user's own code, versions and host."""
    state = code()
    return {
        "version": hjcamp.__version__,
        "git": state.commit,
        "git_changes_sha256": state.sha256,
        "git_changes_bytes": len(state.changes),
        # a notebook writes effects and moves to other folders between its runs
        "own_code_sha256": own_code_sha256(),
        **_environment(),
    }


@cache
def _environment() -> dict[str, Any]:
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "host": platform.node(),
        "system": f"{platform.system()} {platform.machine()}",
        "process": os.getpid(),
    }


@cache
def code() -> CodeState:
    """Return commit and changes of the checkout that this program runs from."""
    return code_state(Path(hjcamp.__file__).resolve().parent.parent)


def log_provenance() -> dict[str, str]:
    """Return what every log says about the program that made it; no time and no host, so equal tests are equal logs."""
    known = provenance()
    packages = ", ".join(f"{name} {version}" for name, version in known["packages"].items() if version)
    facts = {"version": known["version"], "python": known["python"], "packages": packages}
    optional = {"git": git_label(), "git_changes_sha256": code().sha256, "own_code_sha256": known["own_code_sha256"]}
    return facts | {key: str(value) for key, value in optional.items() if value}


def code_identity() -> dict[str, Any]:
    """Return the part of the provenance that decides results: version, commit, changes, the user's own code."""
    known = provenance()
    return {key: known[key] for key in ("version", "git", "git_changes_sha256", "own_code_sha256")}


def git_label() -> str:
    """Return the commit for the metadata of a log, with the hash of the changes on top; empty outside git."""
    commit, changes = code().commit, code().sha256
    return "" if commit is None else commit if changes is None else f"{commit}+{changes[:12]}"


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


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
