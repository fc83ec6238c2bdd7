"""What a reader of another program's files is: one file in `readers`, a class derived from `Reader`."""

from __future__ import annotations

import os
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from hjcamp.records.elsewhere.import_map import ImportMap

MOST_COLUMNS = 20_000
MOST_BYTES = 2**31  # of a column or an unpacked archive; a test is smaller


@dataclass(frozen=True)
class Table:
    """The columns asked for, each of shape (rows,), the times of the rows, s (None: not known), and what to say of them."""

    columns: dict[str, np.ndarray]
    times: np.ndarray | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Column:
    """A column that a file has: the name a map calls it by, and the unit that the file gives it (empty: none).

    ``key``: ``sheet``, ``group`` or ``topic`` of the map, with the value, where the name needs it. ``said``: what the file calls a
    column whose name is a number.
    """

    name: str
    unit: str = ""
    key: tuple[str, str] | None = None
    said: str = ""


class Reader:
    """A kind of file: the ends of its names, what it is called, and the extra of hjcamp with the packages that it needs."""

    name: ClassVar[str]
    endings: ClassVar[tuple[str, ...]]
    says: ClassVar[str]
    extra: ClassVar[str] = ""
    packages: ClassVar[tuple[str, ...]] = ()

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns; raises UsageError for a file that cannot be read and a column that is not there."""
        raise NotImplementedError

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return what the file has that can be a column; raises UsageError for a file that cannot be read."""
        raise NotImplementedError

    def keys(self, source: Path, rules: ImportMap) -> dict[str, object]:
        """Return the keys of a map with which the file is read, such as the lines that stand before its rows."""
        return {}


def need(extra: str, packages: tuple[str, ...], what: str) -> None:
    """Raise UsageError where one of the packages of an extra is not installed; it names the command that installs it."""
    if any(find_spec(package) is None for package in packages):
        raise UsageError(f"{what} needs the extra '{extra}', which is not installed: pip install 'hjcamp[{extra}]'")


@contextmanager
def damage_as_refusal(source: Path, says: str) -> Iterator[None]:
    """Turn what a library raises for damaged bytes, of whatever kind, into one line; keep away what its threads print."""
    sys.stderr.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    except UsageError:
        raise
    except OSError as error:
        said = error.strerror if error.errno and error.strerror else first_line(error)
        raise UsageError(f"{source}: cannot be read as {says}: {said}") from error
    except BaseException as error:
        # a panic of a library in Rust is no Exception
        if not isinstance(error, Exception) and type(error).__name__ != "PanicException":
            raise
        raise UsageError(f"{source}: cannot be read as {says}: {first_line(error)}") from error
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def first_line(error: BaseException) -> str:
    """Return what an error says in one line of bounded length, its kind where it says nothing."""
    text = next(iter(str(error).strip().splitlines()), "") or type(error).__name__
    return text if len(text) <= 200 else f"{text[:200]}..."


def check_width(source: Path, columns: int) -> None:
    """Raise UsageError for a table of more columns than anybody measures."""
    if columns > MOST_COLUMNS:
        raise UsageError(
            f"{source}: {columns} columns; a table has at most {MOST_COLUMNS} (does each row stand on a line of its own?)"
        )


def check_bytes(source: Path, size: int, what: str) -> None:
    """Raise UsageError for what would take more memory than a test does."""
    if size > MOST_BYTES:
        raise UsageError(f"{source}: {what} is {size / 2**30:.3g} GiB; at most {MOST_BYTES / 2**30:g} GiB can be read")


def check_archive(source: Path, says: str) -> None:
    """Raise UsageError where a file is no zip archive, or would unpack to more than a test."""
    with damage_as_refusal(source, says), zipfile.ZipFile(source) as archive:
        check_bytes(source, sum(one.file_size for one in archive.infolist()), "what it unpacks to")


def one_of(kind: str, given: str, allowed: list[str], source: Path) -> str:
    """Return the sheet, group or topic that a map gives, or the only one there is; raises UsageError where that is open."""
    if given:
        if given not in allowed:
            raise unknown(kind, given, allowed, str(source))
        return given
    if len(allowed) != 1:
        listed = ", ".join(allowed[:20]) or "none"
        raise UsageError(f"{source}: has {len(allowed)} {kind}s; say in the map {kind}: NAME, one of {listed}")
    return allowed[0]
