"""A lab with one plant of its own, an axis whose sensor is noisy, and no rig yet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hjcamp.backends.rig import lock
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free

#: The carriage of the template; a reading has a noise of 2 um.
AXIS = TEMPLATE.format(title="Axis1").replace(
    'Measured("encoder", of="position")', 'Measured("encoder", of="position", noise=2e-6)'
)
#: A motion of 0.4 s under a PID, on any rig.
MOTION = (
    "plant=axis1", "controller=plain_pid", "controller.kp=400", "controller.kd=30", "trajectory=cycloid",
    "trajectory.amplitude_m=0.005", "trajectory.rise_time=0.3", "trajectory.duration=0.4",
)  # fmt: skip
RIG = '''"""A bench."""
from hjcamp.rigs.rig import Channel, Rig

class Bench(Rig):
    """The axis on my bench."""
    plant = "axis1"
    channels = (Channel("position_m", range=(-1.0, 1.0)), Channel("voltage", range=(-10.0, 10.0)))
    def read(self):
        return [0.0]
    def write(self, values):
        pass
'''
Made = Callable[..., dict[str, Any]]


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a user's folder that is the working directory, with a home and a folder of locks of its own."""
    (tmp_path / "plants").mkdir()
    (tmp_path / "rigs").mkdir()
    (tmp_path / "plants" / "axis1.py").write_text(AXIS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    monkeypatch.setattr(lock, "lock_folder", lambda: tmp_path)
    yield tmp_path
    lock.release_locks()


@pytest.fixture
def made(lab: Path) -> Made:
    """Return the function that gives the checked configuration of one test."""

    def configuration(*lines: str) -> dict[str, Any]:
        config = Composer().compose([free(line) for line in (*MOTION, *lines)]).config
        check_configuration(config)
        return config

    return configuration
