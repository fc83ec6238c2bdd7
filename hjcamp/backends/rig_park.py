"""Where the pump of a position drive was left, so that the next test brings it back slowly instead of at full speed."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from hjcamp.backends.rig_check_stamp import digest_of, state_folder
from hjcamp.backends.rig_connection import RigUnavailable
from hjcamp.backends.rig_wiring import Wiring


def keeps_its_place(config: Mapping[str, Any], wiring: Wiring) -> bool:
    """Return whether the drive stays where it was told between two tests; a virtual rig begins at rest each time."""
    connection = config["rig"]["connection"]
    real = connection["kind"] == "driver" or (connection["kind"] == "address" and not connection.get("virtual", True))
    return real and wiring.outputs["pump"].safe_v is None


def parked_at(config: Mapping[str, Any], wiring: Wiring) -> float:
    """Return the motor angle (rad) at which the last test on this wiring left the pump, 0 where it went back.

    Raises ``RigUnavailable`` where nobody knows: the last test was killed, and its first write would be a jump.
    """
    if not keeps_its_place(config, wiring) or not _path(config).is_file():
        return 0.0
    try:
        return float(json.loads(_path(config).read_text())["pump_rad"])
    except (OSError, ValueError, KeyError, TypeError):
        name = config["rig"].get("name")
        raise RigUnavailable(
            "the last test on this rig was killed, so nobody knows where the pump stands: "
            f"bring it to its start by hand with the drive switched off, then run `hjcamp rig check rig={name}`"
        ) from None


def note_parked(config: Mapping[str, Any], wiring: Wiring, motor: float | None) -> None:
    """Note the motor angle (rad) at which the pump is left, None while it is under way.

    A disk that refuses must not hide why a test ended.
    """
    if not keeps_its_place(config, wiring):
        return
    path = _path(config)
    part = path.with_name(path.name + ".part")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(json.dumps({"pump_rad": motor}))
        os.replace(part, path)


def _path(config: Mapping[str, Any]) -> Path:
    # The pump stays where it is when a limit or a scale is changed: only its drive decides.
    rig = config["rig"]
    drive = {"connection": rig["connection"], "channel": rig["outputs"]["pump"]["channel"]}
    return state_folder() / f"{rig.get('name', 'rig')}_{digest_of(drive)}.parked"
