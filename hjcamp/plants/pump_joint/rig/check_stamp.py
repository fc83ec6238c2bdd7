"""Whether ``hjcamp rig check`` has passed for a rig as it is configured now, and if not, what has changed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.json_text import read_json
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable
from hjcamp.storage import user_folder, whole_file

DECIDES = (
    "connection", "inputs", "outputs", "limits", "output_timing", "watchdog", "interlock", "sensors",
    "return_speed_mm_per_s",
)  # fmt: skip
# What volts and turns mean outside the rig's own description.
SCALES = (("pump", "lead_mm_per_rev"), ("amplifier", "command_deg_per_v"))
CHECKED = "checked"
SHOWN = 3


def decisive(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return every value that a check of the rig rests on, by its dotted path, as JSON keeps it."""
    rig = {f"rig.{key}": config["rig"].get(key) for key in DECIDES}
    found = rig | {f"{group}.{name}": config[group].get(name) for group, name in SCALES}
    return {path: json.loads(json.dumps(value)) for key, given in found.items() for path, value in _leaves(key, given)}


def stamp_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says what was checked last on this rig: under its name, at this connection."""
    return _place(config, ".json")


def parked_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says where the pump was left; it does not change with a limit or a scale."""
    return _place(config, ".parked")


def write_stamp(config: Mapping[str, Any], findings: Mapping[str, Any]) -> Path:
    """Note that the check has passed; returns the file."""
    path = stamp_path(config)
    content = {"checked_at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), **findings, CHECKED: decisive(config)}
    with whole_file(path) as stream:
        stream.write(json.dumps(content, indent=1).encode())
    return path


def changes(config: Mapping[str, Any]) -> list[str] | None:
    """Return what differs from the last check that passed, nothing where it holds, None where there was none."""
    try:
        then = read_json(stamp_path(config))[CHECKED]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    now = decisive(config)
    if not isinstance(then, dict):
        return None
    return [
        f"{path} was {_shown(then, path)} and is {_shown(now, path)}"
        for path in dict.fromkeys((*now, *then))
        if path not in then or path not in now or then[path] != now[path]
    ]


def require_check(config: Mapping[str, Any]) -> None:
    """Raise ``RigUnavailable`` unless the check has passed, or the user says ``rig.check_required=false``."""
    if not config["rig"].get("check_required", True):
        return
    changed, name = changes(config), config["rig"].get("name")
    if changed == []:
        return
    why = ""
    if changed:
        more = f" and {len(changed) - SHOWN} more" if len(changed) > SHOWN else ""
        why = f" (since the last check {', '.join(changed[:SHOWN])}{more})"
    raise RigUnavailable(
        f"rig '{name}' was not checked as it is configured now{why}, so nothing moves: "
        f"run `hjcamp rig check rig={name}` first, or say rig.check_required=false"
    )


def _place(config: Mapping[str, Any], suffix: str) -> Path:
    """Return a file of this rig; raises ``RigUnavailable`` for a user without a home folder."""
    connection = config["rig"].get("connection") or {}
    where = f"{connection.get('kind')} {connection.get('address')}"
    digest = hashlib.sha256(where.encode()).hexdigest()[:16]
    base = user_folder("XDG_STATE_HOME", ".local", "state")
    if base is None:
        raise RigUnavailable("this user has no home folder to keep a rig's check in: set XDG_STATE_HOME to a folder")
    return base / "hjcamp" / "rig_checks" / f"{config['rig'].get('name', 'rig')}_{digest}{suffix}"


def _leaves(path: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(f"{path}.{key}", item)
    else:
        yield path, value


def _shown(values: Mapping[str, Any], path: str) -> str:
    return str(values[path]) if path in values else "absent"
