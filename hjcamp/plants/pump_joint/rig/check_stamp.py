"""Whether ``hjcamp rig check`` has passed for a rig as it is configured now, and if not, what has changed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.backends.rig import check_stamp

DECIDES = (
    "connection", "inputs", "outputs", "limits", "output_timing", "watchdog", "interlock", "sensors",
    "return_speed_mm_per_s",
)  # fmt: skip
# What volts and turns mean outside the rig's own description.
SCALES = (("pump", "lead_mm_per_rev"), ("amplifier", "command_deg_per_v"))


def decisive(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return every value that a check of the rig rests on, by its dotted path, as JSON keeps it."""
    rig = {f"rig.{key}": config["rig"].get(key) for key in DECIDES}
    found = rig | {f"{group}.{name}": config[group].get(name) for group, name in SCALES}
    values = ((path, value) for key, given in found.items() for path, value in check_stamp.leaves(key, given))
    return {path: json.loads(json.dumps(value)) for path, value in values}


def stamp_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says what was checked last on this rig: under its name, at this connection."""
    return _place(config, ".json")


def parked_path(config: Mapping[str, Any]) -> Path:
    """Return the file that says where the pump was left; it does not change with a limit or a scale."""
    return _place(config, ".parked")


def write_stamp(config: Mapping[str, Any], findings: Mapping[str, Any]) -> Path:
    """Note that the check has passed; returns the file."""
    return check_stamp.write(stamp_path(config), findings, decisive(config))


def changes(config: Mapping[str, Any]) -> list[str] | None:
    """Return what differs from the last check that passed, nothing where it holds, None where there was none."""
    return check_stamp.differences(stamp_path(config), decisive(config))


def require_check(config: Mapping[str, Any]) -> None:
    """Raise ``RigUnavailable`` unless the check has passed, or the user says ``rig.check_required=false``."""
    if config["rig"].get("check_required", True):
        name = config["rig"].get("name")
        check_stamp.refuse_unchecked(str(name), changes(config), f"hjcamp rig check rig={name}")


def _place(config: Mapping[str, Any], suffix: str) -> Path:
    connection = config["rig"].get("connection") or {}
    return check_stamp.state_file(
        config["rig"].get("name", "rig"), f"{connection.get('kind')} {connection.get('address')}", suffix
    )
