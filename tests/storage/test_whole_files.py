"""One way to write a file: whole or not at all, never in the place of a device, a pipe or a link."""

from __future__ import annotations

import errno
import os
import stat
import sys
import threading
from pathlib import Path

import pytest

from hjcamp.errors import HjcampError
from hjcamp.storage import disk_errors, user_folder, whole_file, write_whole


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "file"
    write_whole(target, "old")
    with pytest.raises(ZeroDivisionError), whole_file(target) as stream:
        stream.write(b"new")
        raise ZeroDivisionError
    assert target.read_text() == "old" and [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows opens no folders")
def test_file_and_folder_reach_the_disk_in_that_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[str] = []
    really = os.fsync

    def note(descriptor: int) -> None:
        there = "named" if (tmp_path / "file").exists() else "not named yet"
        synced.append(f"{'folder' if stat.S_ISDIR(os.fstat(descriptor).st_mode) else 'file'}, {there}")
        really(descriptor)

    monkeypatch.setattr("os.fsync", note)
    write_whole(tmp_path / "file", "text")
    assert synced == ["file, not named yet", "folder, named"]


def test_a_link_leads_to_its_file(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "file").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "there" / "file")
    write_whole(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "there" / "file").read_text() == "new"


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_whole(pipe, "through")
    reader.join(10)
    assert read == ["through"] and stat.S_ISFIFO(pipe.stat().st_mode)


def test_a_device_is_written_to() -> None:
    write_whole(Path(os.devnull), "gone")
    assert not Path(os.devnull).is_file()
    if Path("/dev/full").exists():
        said = r"/dev/full: cannot be written: No space left.*the disk is full"
        with pytest.raises(HjcampError, match=said), whole_file(Path("/dev/full")) as stream:
            stream.write(b"text")


@pytest.mark.parametrize(
    ("number", "said"), [(errno.ENOSPC, "the disk is full: do this"), (errno.EROFS, "do that"), (errno.EIO, "error")]
)
def test_what_is_said_of_a_disk_that_refuses(number: int, said: str) -> None:
    told = pytest.raises(HjcampError, match=f"^place: cannot be written: .*{said}")
    with told, disk_errors(Path("place"), full="do this", denied="do that"):
        raise OSError(number, os.strerror(number))


def test_a_user_may_have_no_home(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert user_folder("XDG_CACHE_HOME", ".cache") is None
    monkeypatch.setenv("XDG_CACHE_HOME", "/named")
    assert user_folder("XDG_CACHE_HOME", ".cache") == Path("/named")
