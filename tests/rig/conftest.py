"""A virtual rig in this process: every call goes through the vendor's own client code."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig import lock as rig_lock
from hjcamp.plants.pump_joint.rig.lock import release_locks
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

Compose = Callable[..., dict[str, Any]]


@pytest.fixture(scope="session")
def composer() -> Composer:
    return Composer()


@pytest.fixture(scope="session")
def compose(composer: Composer) -> Compose:
    """Return the function that gives the resolved configuration of a test on the rig."""
    return lambda *lines: composer.compose(["backend=nidaqmx", "trajectory=ramp_pos", *lines]).config


@pytest.fixture
def device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[VirtualDevice]:
    """Return the device of a fresh virtual rig in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    monkeypatch.setattr(rig_lock, "lock_folder", lambda: tmp_path)
    rig_connection._in_process.clear()
    yield rig_connection.in_process_channel().device
    rig_connection._in_process.clear()
    release_locks()
