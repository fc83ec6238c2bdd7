"""One process at a time on a rig. The lock ends with its process, however that ends; the file says whose it is."""

from __future__ import annotations

import getpass
import hashlib
import json
import os
import platform
import re
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.backends.rig_connection import RigUnavailable
from hjcamp.backends.rig_wiring import read_wiring

FOLDER = "hjcamp_rigs"
_held: dict[str, int] = {}


def rig_identity(config: Mapping[str, Any]) -> str | None:
    """Return what names the hardware: server and devices; None for a virtual rig of this process."""
    connection = config["rig"]["connection"]
    if connection["kind"] == "in_process":
        return None
    place = str(connection.get("address")) if connection["kind"] == "address" else "driver"
    return f"{place} {' '.join(sorted(read_wiring(config).devices))}"


def lock_folder() -> Path:
    """Return the folder of all locks, one for all users of this computer."""
    folder = Path(tempfile.gettempdir()) / FOLDER
    folder.mkdir(exist_ok=True)
    with suppress(OSError):
        folder.chmod(0o1777)
    return folder


def lock_path(identity: str) -> Path:
    """Return the file of a lock."""
    folder = lock_folder()
    label = re.sub(r"[^A-Za-z0-9]+", "_", identity)[:40].strip("_")
    return folder / f"{label}_{hashlib.sha256(identity.encode()).hexdigest()[:8]}.lock"


def take_lock(config: Mapping[str, Any]) -> None:
    """Hold the lock of this rig until the process ends; raises ``RigUnavailable`` where another has it."""
    identity = rig_identity(config)
    if identity is None or identity in _held:
        return
    path = lock_path(identity)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    with suppress(OSError):
        os.chmod(path, 0o666)
    if not _take(descriptor):
        holder = read_holder(path)
        os.close(descriptor)
        raise RigUnavailable(f"the rig ({identity}) is in use by {describe(holder)}; see: hjcamp rig unlock")
    content = {
        "rig": identity,
        "process": os.getpid(),
        "user": getpass.getuser(),
        "host": platform.node(),
        "since": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "folder": os.getcwd(),
    }
    os.ftruncate(descriptor, 0)
    os.pwrite(descriptor, json.dumps(content).encode(), 0)
    _held[identity] = descriptor


def release_locks() -> None:
    """Give all locks of this process free; a process that ends need not."""
    while _held:
        os.close(_held.popitem()[1])


def read_holder(path: Path) -> dict[str, Any]:
    """Return what the holder wrote about itself."""
    with suppress(OSError, ValueError):
        content = json.loads(path.read_text())
        if isinstance(content, dict):
            return content
    return {}


def is_free(path: Path) -> bool:
    """Return whether nobody holds the lock of this file."""
    try:
        descriptor = os.open(path, os.O_RDWR)
    except OSError:
        return False
    try:
        return _take(descriptor)
    finally:
        os.close(descriptor)


def describe(holder: Mapping[str, Any]) -> str:
    """Return in words who holds a lock."""
    if not holder:
        return "another process"
    return (
        f"process {holder.get('process')} of {holder.get('user')} on {holder.get('host')}, "
        f"since {holder.get('since')}, started in {holder.get('folder')}"
    )


def _take(descriptor: int) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(descriptor, 4096, os.SEEK_SET)  # beyond the text, which others must be able to read
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
