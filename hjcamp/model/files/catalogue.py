"""Find effects, controllers and other one-class files: a folder is scanned, there is no list."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from hjcamp.errors import UsageError
from hjcamp.model.files.user_file import check_name, load_module

Kind = TypeVar("Kind")


def class_in(path: Path, base: type[Kind], package: str | None = None, name: str = "") -> type[Kind] | None:
    """Return the class derived from ``base`` that the file defines, or None for a file without one.

    It is called ``name``, else like its file.
    """
    module = importlib.import_module(f"{package}.{path.stem}") if package else load_module(path)
    found = [
        value
        for value in vars(module).values()
        if inspect.isclass(value) and issubclass(value, base) and value is not base and value.__module__ == module.__name__
    ]
    if len(found) > 1:
        names = ", ".join(value.__name__ for value in found)
        raise UsageError(f"{path}: one file holds one {base.__name__.lower()}, this one holds {names}")
    if not found:
        return None
    found[0].name = name or path.stem  # type: ignore[attr-defined]
    return found[0]


def files_in(folder: Path, file_of_kind: str) -> list[tuple[str, Path]]:
    """Return the names and files of a user's folder: ``NAME.py``, or ``NAME/plant.py`` where that is the ``file_of_kind``."""
    found = [(path.stem, path) for path in sorted(folder.glob("*.py"))]
    found += [(path.parent.name, path) for path in sorted(folder.glob(f"*/{file_of_kind}"))]
    return [(name, path) for name, path in found if not name.startswith(("_", "."))]


def scan(
    package_folder: Path,
    package: str,
    base: type[Kind],
    folders: Sequence[Path] = (),
    besides: Mapping[str, type[Kind]] | None = None,
) -> dict[str, type[Kind]]:
    """Return every class derived from ``base`` by file name: the package's own, with ``besides`` of ours, then of ``folders``.

    One may be a folder; the class is then in a file of its kind (``plants/NAME/plant.py``).
    """
    found: dict[str, type[Kind]] = dict(besides or {})
    for path in sorted(package_folder.glob("*.py")):
        if not path.stem.startswith("_"):
            own = class_in(path, base, package)
            if own is not None:
                found[path.stem] = own
    file_of_kind = f"{base.__name__.lower()}.py"
    for path in sorted(package_folder.glob(f"*/{file_of_kind}")):
        own = class_in(path, base, f"{package}.{path.parent.name}", path.parent.name)
        if own is not None:
            found[path.parent.name] = own
    found = dict(sorted(found.items()))
    for folder in folders:
        found = scan_files(files_in(folder, file_of_kind), file_of_kind, base, found)
    return found


def scan_files(
    files: Sequence[tuple[str, Path]], file_of_kind: str, base: type[Kind], taken: Mapping[str, type[Kind]]
) -> dict[str, type[Kind]]:
    """Return the classes by name that are ``taken``, and those of a user's files in addition to them; refuse a name that is taken."""
    found = dict(taken)
    for name, path in files:
        check_name(path if path.name != file_of_kind else path.parent)
        theirs = class_in(path, base, name=name)
        if theirs is None:
            raise UsageError(f"{path}: no class derived from {base.__name__} in this file")
        if name in found:
            raise UsageError(f"{path}: the name '{name}' is taken; choose another file name")
        found[name] = theirs
    return found
