"""Locks between processes: a lock ends with its process, however that ends, and its file says who holds it."""

from __future__ import annotations

import errno
import getpass
import os
import sys
import time
from pathlib import Path

from hjcamp.errors import HjcampError

# Who only looks takes a lock for an instant: whoever wants it waits that long.
PATIENCE_S = 0.25


def take(path: Path, text: str, mode: int = 0o644) -> int | None:
    """Hold the lock of the file ``path`` and write ``text`` into it; returns what `release` needs, None where it is held.

    Raises `HjcampError` where the file is a link of either kind, ``OSError`` where it cannot be opened.
    """
    descriptor = _opened(path, mode)
    try:
        last = time.monotonic() + PATIENCE_S
        while not _lock(descriptor):
            if time.monotonic() > last:
                os.close(descriptor)
                return None
            time.sleep(0.01)
        os.ftruncate(descriptor, 0)
        os.write(descriptor, text.encode())
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def release(descriptor: int) -> None:
    """Give a lock free."""
    os.close(descriptor)


def is_held(path: Path) -> bool:
    """Return whether a process holds the lock of this file; raises ``OSError`` where the file cannot be opened."""
    descriptor = os.open(path, os.O_RDONLY | _NO_LINK)
    try:
        return not _lock(descriptor, shared=True)
    finally:
        os.close(descriptor)


def user_name() -> str:
    """Return the user's name, or the number of a user that no passwd entry names."""
    try:
        return getpass.getuser()
    except (KeyError, OSError, ImportError):
        return str(os.getuid()) if hasattr(os, "getuid") else "unknown"


_NO_LINK = getattr(os, "O_NOFOLLOW", 0)


def _opened(path: Path, mode: int) -> int:
    if path.is_symlink():
        raise _is_a_link(path)
    while True:
        try:
            # Not made where it is there: some systems refuse that for another user's file in a folder of all users.
            return _of_one_name(path, os.open(path, os.O_RDWR | _NO_LINK))
        except FileNotFoundError:
            pass
        except OSError as error:
            if error.errno != errno.ELOOP:
                raise
            raise _is_a_link(path) from None
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | _NO_LINK, mode)
        except FileExistsError:
            if path.is_symlink():
                raise _is_a_link(path) from None
            continue
        if hasattr(os, "fchmod"):
            os.fchmod(descriptor, mode)  # whatever the user's mask says
        return descriptor


def _of_one_name(path: Path, descriptor: int) -> int:
    """Return the descriptor of a file that has no other name (a hard link), whose content would be lost."""
    if os.fstat(descriptor).st_nlink > 1:
        os.close(descriptor)
        raise _is_a_link(path)
    return descriptor


def _is_a_link(path: Path) -> HjcampError:
    return HjcampError(f"{path} is a link, and a lock follows none: remove it")


def _lock(descriptor: int, shared: bool = False) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(descriptor, 4096, os.SEEK_SET)  # beyond the text, which others must be able to read
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            os.lseek(descriptor, 0, os.SEEK_SET)
        else:
            import fcntl

            fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
