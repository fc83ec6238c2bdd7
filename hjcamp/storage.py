"""Write files whole or not at all, and say in one way why a file cannot be written; where the user's own folders are."""

from __future__ import annotations

import errno
import os
import re
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from hjcamp.errors import LONGEST_SHOWN, HjcampError, UsageError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# A disk takes 255 bytes, and what is being written has a longer name.
LONGEST_NAME = 200
VALUE = re.compile(r"=(-?\d+(?:\.\d+)?(?:e-?\d+)?)")
LONGEST_STEM = 120
CHOICE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
DENIED = (errno.EACCES, errno.EPERM, errno.EROFS)
_received: dict[Path, None] = {}


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


def check_is_file(path: Path) -> None:
    """Raise ``UsageError`` for a pipe or a device in the place of a file that is read: nobody may ever write to it."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise UsageError(f"{shown_path(path)}: cannot be read: this is a pipe or a device, no file")


def check_place(path: Path, what: str = "", folder: bool = False) -> None:
    """Raise ``UsageError`` where no file (or ``folder``) can be made at ``path``, before any work is done for it.

    ``what`` names the option that gave the path.
    """
    said = f"{what} {shown_path(path)}".strip()
    if any(ord(letter) < 32 for letter in str(path)):
        raise UsageError(f"{said}: a name cannot hold control characters")
    for part in path.parts:
        if len(os.fsencode(part)) > LONGEST_NAME:
            raise UsageError(f"{said}: a name of {len(part)} letters; at most {LONGEST_NAME} are allowed")
    try:
        found = next((place for place in (path, *path.parents) if place.is_symlink() or place.exists()), Path("."))
        is_folder = found.resolve().is_dir() if found.exists() else None
    except (OSError, ValueError, RuntimeError) as error:
        raise UsageError(f"{said}: {getattr(error, 'strerror', None) or error}") from error
    if found == path and is_folder is not None and is_folder != folder:
        raise UsageError(f"{said}: this is a {'file; give a folder' if folder else 'folder; give a file'}")
    if found != path and not is_folder:
        raise UsageError(f"{said}: {shown_path(found)} is no folder")
    if is_folder is not None and not os.access(found, os.W_OK):
        raise HjcampError(f"{said}: cannot be written: {shown_path(found)} may not be written to")
    if found != path:
        with disk_errors(Path(said)):
            _try_folder(path if folder else path.parent, found)


def _try_folder(path: Path, there: Path) -> None:
    """Make the folders below ``there`` and take them away again: /proc says it may be written to, and may not."""
    missing = [place for place in (path, *path.parents) if place != there and there in place.parents]
    made = []
    try:
        for place in reversed(missing):
            if not place.exists():  # a/.. does, once a was made
                place.mkdir()
                made.append(place)
    finally:
        for place in reversed(made):
            place.rmdir()


def named_file(name: str, kind: str, *folders: Path) -> list[Path]:
    """Return NAME.yaml in each folder; raises ``UsageError`` for a name that cannot be that of a ``kind`` of choice."""
    if not CHOICE_NAME.fullmatch(name):
        said = shown_path(Path(name)) if name else ""
        raise UsageError(f"'{said}' cannot be the name of a {kind}: use letters, digits, _ and -")
    paths = [folder / f"{name}.yaml" for folder in folders]
    for path in paths:
        check_place(path)
    return paths


def file_name(text: str, usual: str = "test") -> str:
    """Return a condition, a model or another text as the name of a file: one part of a path, whatever the text holds."""
    return re.sub(r"[^\w.=+-]+", "__", values_spelled(text)).strip("._")[:LONGEST_STEM] or usual


def values_spelled(name: str) -> str:
    """Return a name with its values as files have them: ``kp=-0.7`` is ``kpm0p7``."""
    return VALUE.sub(lambda found: found[1].replace(".", "p").replace("-", "m"), name)


def file_names(texts: Iterable[str]) -> list[str]:
    """Return a name of a file for each text, no two of them equal on any disk."""
    taken: dict[str, str] = {}
    for text in texts:
        name, number = file_name(text), 1
        while (one := name if number == 1 else f"{name}_{number}").casefold() in taken:
            number += 1
        taken[one.casefold()] = one
    return list(taken.values())


def shown_path(path: Path) -> str:
    """Return a path as a message shows it: one line, and not without end."""
    text = str(path)
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= 2 * LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


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


def new_part(part: Path) -> IO[bytes]:
    """Open a file that is not there yet; one that was left is replaced, and a link in its place is not followed."""
    refuse_links(part)
    part.unlink(missing_ok=True)
    return open(part, "xb")


def keep_within(folder: Path) -> None:
    """Let nothing be written through a link in a folder that may be somebody else's, such as one of logs."""
    for one in (Path(os.path.abspath(folder)), folder.resolve()):
        _received[one] = None


def own_folder(folder: Path) -> Path:
    """Return a folder of a name of ours, through which nothing is written elsewhere; raises ``UsageError`` for links there."""
    inside = (Path(place, name) for place, folders, files in os.walk(folder) for name in (*folders, *files))
    for one in (folder, *inside):
        if one.is_symlink():
            raise UsageError(f"{shown_path(one)} is a link, and would lead what is written elsewhere: remove it")
    keep_within(folder)
    return folder


def refuse_links(path: Path) -> None:
    """Raise ``UsageError`` where a file below a folder of logs would be written through a link, a pipe or a device."""
    whole = Path(os.path.abspath(path))
    for root in [one for one in whole.parents if one in _received]:
        place = root
        for part in whole.relative_to(root).parts:
            place /= part
            if place.is_symlink():
                raise UsageError(f"{shown_path(place)} is a link; next to logs nothing is written through a link: remove it")
        if place.exists() and not place.is_file() and not place.is_dir():
            raise UsageError(f"{shown_path(place)} is a pipe or a device, and stands where a file is written: remove it")


@contextmanager
def _atomic(path: Path, suffix: str = "part") -> Iterator[IO[bytes]]:
    refuse_links(path)
    if path.exists() and not path.is_file() and not path.is_dir():
        with open(path, "wb") as stream:
            yield stream
        return
    target = path.resolve() if path.is_symlink() else path
    part = target.with_name(f"{target.name}.{suffix}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with new_part(part) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        put_in_place(part, target)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def remove_files(paths: Iterable[Path]) -> None:
    """Remove files, as far as the disk lets."""
    for path in paths:
        with suppress(OSError):
            path.unlink()
