"""Locks: no link is followed, a look does not hinder, one computer has one name, and a user may have no name."""

from __future__ import annotations

import getpass
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pytest

import hjcamp
from hjcamp import locks
from hjcamp.campaign.files.lock import is_locked, run_lock
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.rig import lock as rig_lock
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable

HOMELESS = """
import json, os, sys
os.setresuid(12345, 0, 0)  # the number that home and name are looked up by; files stay open to this process
from hjcamp.plants.pump_joint.rig import lock as rig_lock
from hjcamp import cli
rig_lock.rig_identity = lambda config: "the rig of nobody"
rig_lock.take_lock({})
print(json.dumps(rig_lock.read_holder(rig_lock.lock_path("the rig of nobody"))["user"]))
from pathlib import Path
from hjcamp.campaign.files.lock import run_lock
with run_lock(Path.cwd()):
    sys.exit(cli.run(["doctor"]))
"""


@pytest.fixture
def precious(tmp_path: Path) -> Path:
    """A file that nobody may overwrite."""
    path = tmp_path / "precious"
    path.write_text("precious")
    return path


def test_a_run_lock_follows_no_link(tmp_path: Path, precious: Path) -> None:
    (tmp_path / ".lock").symlink_to(precious)
    with pytest.raises(HjcampError, match="is a link, and a lock follows none"), run_lock(tmp_path):
        pass
    assert precious.read_text() == "precious" and not is_locked(tmp_path)


def test_a_lock_with_another_name_is_left_alone(tmp_path: Path, precious: Path) -> None:
    os.link(precious, tmp_path / ".lock")
    with pytest.raises(HjcampError, match="is a link, and a lock follows none"), run_lock(tmp_path):
        pass
    assert precious.read_text() == "precious"
    (tmp_path / ".lock").unlink()
    with run_lock(tmp_path):
        assert is_locked(tmp_path)


@pytest.mark.parametrize("what", ["file", "dangling file", "folder"])
def test_a_rig_lock_follows_no_link(what: str, tmp_path: Path, precious: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rig_lock, "rig_identity", lambda config: "a rig")
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    if what == "folder":
        (tmp_path / "theirs").mkdir(mode=0o755)
        (tmp_path / rig_lock.FOLDER).symlink_to(tmp_path / "theirs")
    else:
        rig_lock.lock_path("a rig").symlink_to(precious if what == "file" else tmp_path / "made by a lock")
    with pytest.raises(RigUnavailable, match="is a link"):
        rig_lock.take_lock({})
    assert precious.read_text() == "precious"
    assert not (tmp_path / "made by a lock").exists()
    if what == "folder":
        assert (tmp_path / "theirs").stat().st_mode & 0o7777 == 0o755 and not any((tmp_path / "theirs").iterdir())


def test_a_look_does_not_hinder(tmp_path: Path) -> None:
    ended = threading.Event()

    def look() -> None:
        while not ended.is_set():
            is_locked(tmp_path)

    with run_lock(tmp_path):
        assert is_locked(tmp_path)
    lookers = [threading.Thread(target=look) for _ in range(2)]
    for looker in lookers:
        looker.start()
    try:
        for _ in range(200):
            with run_lock(tmp_path):
                pass
    finally:
        ended.set()
        for looker in lookers:
            looker.join()


def test_a_held_lock_is_refused_soon(tmp_path: Path) -> None:
    held = locks.take(tmp_path / "lock", "me")
    assert held is not None
    begin = time.monotonic()
    assert locks.take(tmp_path / "lock", "you") is None
    assert time.monotonic() - begin < 5.0 and (tmp_path / "lock").read_text() == "me"
    locks.release(held)
    assert not locks.is_held(tmp_path / "lock")


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST", "127.0.0.1", "[::1]", "::1", "ipv4:127.0.0.1", "dns:localhost"])
def test_this_computer_is_one_rig(host: str) -> None:
    assert rig_lock.one_name(f"{host}:31763") == "localhost:31763"


def test_other_computers_and_ports_are_other_rigs() -> None:
    names = {rig_lock.one_name(f"{name}:31763") for name in ("bench", "192.168.1.7", "[fe80::1]", "localhost")}
    assert len(names) == 4 and rig_lock.one_name("127.0.0.1:1") != rig_lock.one_name("127.0.0.1:2")


def test_a_user_without_a_name_has_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    def nameless() -> str:
        raise KeyError("getpwuid(): uid not found: 12345")

    monkeypatch.setattr(getpass, "getuser", nameless)
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert locks.user_name() == "12345"


@pytest.mark.skipif(not hasattr(os, "setresuid") or os.geteuid() != 0, reason="only root may take another number")
def test_a_user_of_whom_nothing_is_known() -> None:
    """Nobody's number, no HOME: the rig lock, the run lock and the doctor work."""
    kept = {key: value for key, value in os.environ.items() if key in ("PATH", "LANG")}
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        environment = {**kept, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1]), "TMPDIR": folder}
        done = subprocess.run(
            [sys.executable, "-c", HOMELESS], cwd=folder, env=environment, capture_output=True, text=True, timeout=120
        )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith('"12345"')
    assert "BROKEN" not in done.stdout and "no home folder" in done.stdout
