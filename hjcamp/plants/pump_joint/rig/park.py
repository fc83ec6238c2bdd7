"""Where the pump of a position drive was left, so that the next test brings it back slowly instead of at full speed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.backends.rig.guard import is_real
from hjcamp.json_text import read_json
from hjcamp.plants.pump_joint.rig.check_stamp import parked_path
from hjcamp.plants.pump_joint.rig.wiring import Wiring
from hjcamp.storage import write_whole


def keeps_its_place(config: Mapping[str, Any], wiring: Wiring) -> bool:
    """Return whether the drive stays where it was told between two tests; a virtual rig begins at rest each time."""
    return is_real(config) and wiring.outputs["pump"].safe_v is None


def parked_at(config: Mapping[str, Any], wiring: Wiring) -> float:
    """Return the motor angle (rad) at which the last test on this wiring left the pump, 0 where it went back.

    Raises ``RigUnavailable`` where nobody knows (the last test was killed, or could not write its outputs): the first
    write would be a jump.
    """
    if not keeps_its_place(config, wiring) or not parked_path(config).is_file():
        return 0.0
    try:
        return float(read_json(parked_path(config))["pump_rad"])
    except (OSError, ValueError, KeyError, TypeError):
        name = config["rig"].get("name")
        raise RigUnavailable(
            "the last test on this rig was killed or could not write its outputs, so nobody knows where the pump stands: "
            f"bring it to its start by hand with the drive switched off, then run `hjcamp rig check rig={name}`"
        ) from None


def note_parked(config: Mapping[str, Any], wiring: Wiring, motor: float | None) -> None:
    """Note the motor angle (rad) at which the pump is left, None while it is under way.

    A disk that refuses must not hide why a test ended.
    """
    if not keeps_its_place(config, wiring):
        return
    path = parked_path(config)
    with suppress(OSError):
        write_whole(path, json.dumps({"pump_rad": motor}))
