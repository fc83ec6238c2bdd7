"""One way to write a file: whole or not at all, never in the place of a device, a pipe or a link."""

from __future__ import annotations

import errno
import os
import stat
import sys
import threading
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hjcamp.errors import HjcampError, UsageError
from hjcamp.storage import (
    disk_errors,
    file_name,
    file_names,
    keep_within,
    new_part,
    user_folder,
    whole_file,
    write_whole,
)


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


@pytest.mark.parametrize("link", ["out.txt", "out.txt.part", "below", "below/deeper"])
def test_beside_logs_nothing_is_written_through_a_link(tmp_path: Path, link: str) -> None:
    precious, received = tmp_path / "precious", tmp_path / "received"
    precious.mkdir()
    received.mkdir()
    (precious / "out.txt").write_text("mine")
    keep_within(received)
    target = received / ("below/deeper/out.txt" if link.startswith("below") else "out.txt")
    (received / link).parent.mkdir(exist_ok=True)
    (received / link).symlink_to(precious if link.startswith("below") else precious / "out.txt")
    with pytest.raises(UsageError, match=f"{link} is a link"):
        new_part(received / link)
    if link.endswith(".part"):
        write_whole(target.with_name("other"), "theirs")  # a link under another name hinders nothing
    else:
        with pytest.raises(UsageError, match=f"{link} is a link"):
            write_whole(target, "theirs")
    assert (precious / "out.txt").read_text() == "mine" and [one.name for one in precious.iterdir()] == ["out.txt"]


def test_a_pipe_beside_logs_is_not_waited_for(tmp_path: Path) -> None:
    keep_within(tmp_path)
    os.mkfifo(tmp_path / "report.html")
    with pytest.raises(UsageError, match="is a pipe or a device"):
        write_whole(tmp_path / "report.html", "text")


def test_a_folder_reached_through_a_link_is_the_users_own(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "latest").symlink_to(tmp_path / "disk")
    keep_within(tmp_path / "latest")
    write_whole(tmp_path / "latest" / "compare" / "index.html", "text")
    assert (tmp_path / "disk" / "compare" / "index.html").read_text() == "text"


HOSTILE = [
    "../../evil",
    "/etc/passwd",
    "..",
    ".",
    "",
    "a/../../b",
    "a\\b",
    "a\nb",
    "\x00",
    "\x1b]0;x\x07",
    "con:aux",
    "é" * 500,
]


@given(st.text())
@settings(max_examples=200, deadline=None)
def test_a_text_becomes_one_part_of_a_path(text: str) -> None:
    for one in (text, *HOSTILE):
        name = file_name(one)
        assert Path("folder", name).parts == ("folder", name) and name not in ("", ".", "..") and name.isprintable()
        assert not name.startswith(".") and len(os.fsencode(f"{name}.mcap.part")) <= 255


def test_names_of_files_differ_on_every_disk() -> None:
    names = file_names(["a", "A", "a", "a_2", "../a", "b/c", "b__c", *HOSTILE])
    assert len({one.casefold() for one in names}) == len(names) and names[0] == "a" and names[6] != "b__c"


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
