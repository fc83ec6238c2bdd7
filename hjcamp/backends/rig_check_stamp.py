"""Whether ``hjcamp rig check`` has passed for a rig as it is configured now."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.backends.rig_connection import RigUnavailable
from hjcamp.storage import user_folder, whole_file

DECIDES = ("connection", "inputs", "outputs", "limits", "output_timing", "watchdog", "sensors")


def stamp_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says that this wiring, with these limits, was checked; another wiring has another.

    Raises ``RigUnavailable`` for a user without a home folder.
    """
    rig = {key: config["rig"].get(key) for key in DECIDES}
    digest = hashlib.sha256(json.dumps(rig, sort_keys=True).encode()).hexdigest()[:16]
    base = user_folder("XDG_STATE_HOME", ".local", "state")
    if base is None:
        raise RigUnavailable("this user has no home folder to keep a rig's check in: set XDG_STATE_HOME to a folder")
    return base / "hjcamp" / "rig_checks" / f"{config['rig'].get('name', 'rig')}_{digest}.json"


def write_stamp(config: Mapping[str, Any], findings: Mapping[str, Any]) -> Path:
    """Note that the check has passed; returns the file."""
    path = stamp_path(config)
    content = {"checked_at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), **findings}
    with whole_file(path) as stream:
        stream.write(json.dumps(content, indent=1).encode())
    return path


def require_check(config: Mapping[str, Any]) -> None:
    """Raise ``RigUnavailable`` unless the check has passed, or the user says ``rig.check_required=false``."""
    if config["rig"].get("check_required", True) and not stamp_path(config).is_file():
        name = config["rig"].get("name")
        raise RigUnavailable(
            f"rig '{name}' was not checked as it is configured now, so nothing moves: "
            f"run `hjcamp rig check rig={name}` first, or say rig.check_required=false"
        )
