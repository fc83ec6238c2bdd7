"""Write a file whole or not at all."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hjcamp.errors import HjcampError


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write to ``NAME.part``, flush to the disk, then take the final name; on failure nothing is left behind."""
    part = path.with_name(path.name + ".part")
    data = content.encode() if isinstance(content, str) else content
    try:
        with part.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def write_json(path: Path, content: Any) -> None:
    """Write plain values as JSON, whole or not at all."""
    write_atomic(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


@contextmanager
def disk_errors(place: Path) -> Iterator[None]:
    """Turn a full or read-only disk into one clear message."""
    try:
        yield
    except OSError as error:
        raise HjcampError(disk_message(error, place)) from error


def disk_message(error: OSError, place: Path) -> str:
    """Return what to say about a failed write."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return f"the disk is full: cannot write to {place}. Free space, then go on with: hjcamp resume {place}"
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        return f"cannot write to {place}: {error.strerror}. Choose another folder with run_dir=DIR"
    return f"cannot write to {place}: {error.strerror or error}"
