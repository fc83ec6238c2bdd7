"""Write files whole or not at all, and say in one way why a file cannot be written; where the user's own folders are."""

from __future__ import annotations

import errno
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from hjcamp.errors import HjcampError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
DENIED = (errno.EACCES, errno.EPERM, errno.EROFS)


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """Give a stream to ``NAME.part``, which takes its final name at the end and vanishes on an exception.

    A device or a pipe is written to, and a link leads to its file: neither is replaced. `HjcampError` where it fails.
    """
    with disk_errors(path), _atomic(path) as stream:
        yield stream


def write_whole(path: Path, content: str | bytes, shared: bool = False) -> None:
    """Write a file as `whole_file` does; raises ``OSError``, for those who know more about the place.

    ``shared``: several processes may write it at once, and the last one wins.
    """
    with _atomic(path, f"{uuid.uuid4().hex}.part" if shared else "part") as stream:
        stream.write(content.encode() if isinstance(content, str) else content)


def put_in_place(part: Path, path: Path) -> None:
    """Give a finished file, already on the disk, its final name, so that a power cut cannot take the name away."""
    os.replace(part, path)
    # Windows opens no folders, and some network disks refuse: there the name alone is at risk, never the content.
    with suppress(OSError):
        descriptor = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


@contextmanager
def disk_errors(place: Path, full: str = "free space and try again", denied: str = "") -> Iterator[None]:
    """Turn an ``OSError`` into a `HjcampError` with the place, the reason and what to do on a full or closed disk."""
    try:
        yield
    except OSError as error:
        advice = f"the disk is full: {full}" if error.errno in FULL else denied if error.errno in DENIED else ""
        reason = f"{error.strerror or error}" + (f" ({advice})" if advice else "")
        raise HjcampError(f"{place}: cannot be written: {reason}") from error


def user_folder(variable: str, *below_home: str) -> Path | None:
    """Return the folder that ``variable`` names, else the one below the home folder; None for a user without a home."""
    named = os.environ.get(variable)
    try:
        return Path(named) if named else Path.home().joinpath(*below_home)
    except RuntimeError:  # no HOME, and a user number that no passwd entry names, as in a container
        return None


@contextmanager
def _atomic(path: Path, suffix: str = "part") -> Iterator[IO[bytes]]:
    if path.exists() and not path.is_file() and not path.is_dir():
        with open(path, "wb") as stream:
            yield stream
        return
    target = path.resolve() if path.is_symlink() else path
    part = target.with_name(f"{target.name}.{suffix}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with open(part, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        put_in_place(part, target)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise
