"""Whether ``hjcamp rig check`` has passed for a rig as it is configured now."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.backends.rig_connection import RigUnavailable
from hjcamp.errors import HjcampError

DECIDES = ("connection", "inputs", "outputs", "limits", "output_timing", "watchdog", "sensors")
SCALES = (("pump", "lead_mm_per_rev"), ("amplifier", "command_deg_per_v"))


def stamp_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says that this wiring, with these scales and limits, was checked; another has another."""
    rig = {key: config["rig"].get(key) for key in DECIDES}
    rig |= {f"{group}.{key}": config[group].get(key) for group, key in SCALES}
    return state_folder() / f"{config['rig'].get('name', 'rig')}_{digest_of(rig)}.json"


def digest_of(content: Mapping[str, Any]) -> str:
    """Return a short hash of plain values."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def state_folder() -> Path:
    """Return the folder of what is remembered of this computer's rigs."""
    base = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    return base / "hjcamp" / "rig_checks"


def write_stamp(config: Mapping[str, Any], findings: Mapping[str, Any]) -> Path:
    """Note that the check has passed; returns the file."""
    path = stamp_path(config)
    content = {"checked_at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), **findings}
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(json.dumps(content, indent=1))
        os.replace(part, path)
    except OSError as error:
        raise HjcampError(f"{path}: cannot be written: {error.strerror or error}") from error
    return path


def require_check(config: Mapping[str, Any]) -> None:
    """Raise ``RigUnavailable`` unless the check has passed, or the user says ``rig.check_required=false``."""
    if config["rig"].get("check_required", True) and not stamp_path(config).is_file():
        name = config["rig"].get("name")
        raise RigUnavailable(
            f"rig '{name}' was not checked as it is configured now, so nothing moves: "
            f"run `hjcamp rig check rig={name}` first, or say rig.check_required=false"
        )
