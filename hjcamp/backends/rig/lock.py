"""One process at a time on a rig. The lock ends with its process, however that ends; the file says whose it is."""

from __future__ import annotations

import hashlib
import ipaddress
import json
import os
import platform
import re
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp import locks
from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.errors import HjcampError
from hjcamp.json_text import read_json

FOLDER = "hjcamp_rigs"
_held: dict[str, int] = {}


def one_name(address: str) -> str:
    """Return HOST:PORT with one name for this computer, which has many: localhost, 127.0.0.1, [::1], its own name."""
    host, _, port = re.sub(r"^(dns:(///?)?|ipv4:|ipv6:)", "", address.strip()).rpartition(":")
    host = host.strip("[]").lower()
    try:
        known = ipaddress.ip_address(host)
        here = known.is_loopback or known.is_unspecified
    except ValueError:
        here = host in ("localhost", "ip6-localhost", platform.node().lower())
    return f"{'localhost' if here else host}:{port}"


def lock_folder() -> Path:
    """Return the folder of all locks, one for all users of this computer; raises ``RigUnavailable`` where it is none."""
    folder = Path(tempfile.gettempdir()) / FOLDER
    try:
        folder.mkdir()
        folder.chmod(0o1777)
    except FileExistsError:
        pass
    except OSError as error:
        raise RigUnavailable(f"the folder of the rig locks {folder} cannot be made: {error.strerror}") from error
    if folder.is_symlink() or not folder.is_dir():
        raise RigUnavailable(f"{folder} is a link or a file, so no lock can be kept there: remove it")
    return folder


def lock_file(folder: Path, identity: str) -> Path:
    """Return the file of a lock in the folder of all."""
    label = re.sub(r"[^A-Za-z0-9]+", "_", identity)[:40].strip("_")
    return folder / f"{label}_{hashlib.sha256(identity.encode()).hexdigest()[:8]}.lock"


def hold(identity: str, folder: Path | None = None) -> None:
    """Hold the lock of a rig until the process ends; raises ``RigUnavailable`` where another has it."""
    if identity in _held:
        return
    path = lock_file(lock_folder() if folder is None else folder, identity)
    content = {
        "rig": identity,
        "process": os.getpid(),
        "user": locks.user_name(),
        "host": platform.node(),
        "since": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "folder": os.getcwd(),
    }
    try:
        descriptor = locks.take(path, json.dumps(content), 0o666)
    except HjcampError as error:
        raise RigUnavailable(str(error)) from error
    except OSError as error:
        raise RigUnavailable(f"the lock of the rig {path} cannot be taken: {error.strerror or error}") from error
    if descriptor is None:
        holder = describe(read_holder(path))
        raise RigUnavailable(f"the rig ({identity}) is in use by {holder}; see: hjcamp rig unlock")
    _held[identity] = descriptor


def release_locks() -> None:
    """Give all locks of this process free; a process that ends need not."""
    while _held:
        locks.release(_held.popitem()[1])


def read_holder(path: Path) -> dict[str, Any]:
    """Return what the holder wrote about itself."""
    with suppress(OSError, ValueError):
        content = read_json(path)
        if isinstance(content, dict):
            return content
    return {}


def is_free(path: Path) -> bool:
    """Return whether nobody holds the lock of this file."""
    try:
        return not locks.is_held(path)
    except OSError:
        return False


def describe(holder: Mapping[str, Any]) -> str:
    """Return in words who holds a lock."""
    if not holder:
        return "another process"
    return (
        f"process {holder.get('process')} of {holder.get('user')} on {holder.get('host')}, "
        f"since {holder.get('since')}, started in {holder.get('folder')}"
    )
