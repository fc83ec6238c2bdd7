"""A disk that is really full: the system refuses the write, not a stand-in."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from full_disk import FULL_AT

from hjcamp import backends
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

SCRIPT = Path(__file__).with_name("full_disk.py")
NAMESPACE = ("unshare", "--user", "--map-root-user", "--mount", "sh", "-c")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="RLIMIT_FSIZE and mount namespaces")


def run_full(kind: str, folder: Path) -> dict[str, Any]:
    """Return what the script saw, in a folder that ends with its own small file system for ``disk``."""
    call = f"cd {shlex.quote(str(folder))} && exec {shlex.join([sys.executable, str(SCRIPT), kind])}"
    mount = f"mount -t tmpfs -o size=4m tmpfs {shlex.quote(str(folder))} && " if kind == "disk" else ""
    environment = {**os.environ, "PYTHONPATH": str(SCRIPT.parents[2]), "PYTHONWARNINGS": "error"}
    command = [*(NAMESPACE if kind == "disk" else ("sh", "-c")), mount + call]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return dict(json.loads(done.stdout.splitlines()[-1]))


def can_mount(folder: Path) -> bool:
    """Return whether this machine gives a process a file system of its own."""
    if shutil.which("unshare") is None:
        return False
    probe = [*NAMESPACE, f"mount -t tmpfs -o size=64k tmpfs {shlex.quote(str(folder))}"]
    return subprocess.run(probe, capture_output=True).returncode == 0


@pytest.mark.parametrize("kind", ["limit", pytest.param("disk", marks=pytest.mark.study)])
def test_a_full_disk_makes_the_rig_safe(kind: str, tmp_path: Path, compose: Any, device: VirtualDevice) -> None:
    folder = tmp_path / "small"
    folder.mkdir()
    if kind == "disk" and not can_mount(folder):
        pytest.skip("no mount namespaces here")
    # What it compiles is kept outside the small disk.
    backends.run_test(compose("trajectory.duration=0.05", "trajectory.rise_time=0.05"), 1)
    seen = run_full(kind, folder)
    assert seen["code"] == 3, seen
    assert "the rig was made safe: the log cannot be written" in seen["said"]
    assert {"limit": "File too large", "disk": "No space left on device"}[kind] in seen["said"]
    assert "2 tests left; go on with: hjcamp resume run" in seen["said"]
    assert "Traceback" not in seen["said"]
    assert seen["tests"] == 1, "a run whose log cannot be written must not go on"
    assert (seen["volts"]["Dev1/ao1"], seen["volts"]["Dev1/ao2"]) == (0.0, 0.0)
    assert FULL_AT < seen["samples"] < 2600, "stopped before the test was over"
    assert FULL_AT - 200 <= seen["kept"] <= seen["samples"]
    assert seen["final"] == 0
    assert (seen["resumed"], seen["whole"]) == (0, 2)
