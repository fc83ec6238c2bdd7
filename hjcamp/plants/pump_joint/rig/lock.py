"""Which hardware a configuration of this joint names, and its lock."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.backends.rig.lock import (
    FOLDER,
    describe,
    hold,
    is_free,
    lock_file,
    lock_folder,
    one_name,
    read_holder,
    release_locks,
)
from hjcamp.plants.pump_joint.rig.wiring import read_wiring

__all__ = [
    "FOLDER", "describe", "is_free", "lock_folder", "lock_path", "one_name", "read_holder", "release_locks", "rig_identity",
    "take_lock",
]  # fmt: skip


def rig_identity(config: Mapping[str, Any]) -> str | None:
    """Return what names the hardware: server and devices; None for a virtual rig of this process."""
    connection = config["rig"]["connection"]
    if connection["kind"] == "in_process":
        return None
    place = one_name(str(connection.get("address"))) if connection["kind"] == "address" else "driver"
    return f"{place} {' '.join(sorted(read_wiring(config).devices))}"


def lock_path(identity: str) -> Path:
    """Return the file of a lock."""
    return lock_file(lock_folder(), identity)


def take_lock(config: Mapping[str, Any]) -> None:
    """Hold the lock of this rig until the process ends; raises ``RigUnavailable`` where another has it."""
    identity = rig_identity(config)
    if identity is not None:
        hold(identity, lock_folder())
