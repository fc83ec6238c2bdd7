"""Find the kinds of trajectory by scanning folders, and build one from its configuration."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.files.user_file import load_module
from hjcamp.model.files.user_folders import extension_folders
from hjcamp.model.language.field_unit import FieldUnit
from hjcamp.trajectories.base import Trajectory

DEGREES = "deg"
OWN_FOLDER = Path(__file__).parent


def build_trajectory(
    config: Mapping[str, Any], folders: Sequence[Path] | None = None, unit: FieldUnit | None = None
) -> Trajectory:
    """Return the trajectory that a resolved ``trajectory`` group describes: ``kind``, ``name`` and parameters.

    ``folders`` are the folders of kinds next to our own, by default the user's ``trajectories``. `UsageError` for an
    unknown kind or parameter, a missing one, or a value that is not allowed.
    With a ``unit`` other than deg the parameters are named by it (``amplitude_mm``), and its numbers stand for degrees.
    """
    if not isinstance(config, Mapping):
        raise UsageError(f"trajectory is {config!r}; a kind with its parameters is needed")
    kinds = find_kinds(extension_folders("trajectories") if folders is None else folders)
    kind = config.get("kind")
    if kind is None:
        raise UsageError(f"trajectory.kind is missing. Allowed: {', '.join(sorted(kinds))}")
    if not isinstance(kind, str) or kind not in kinds:
        raise unknown("trajectory kind", str(kind), kinds, "trajectory.kind")
    chosen = kinds[kind]
    parameters = {name: value for name, value in config.items() if name not in ("name", "kind")}
    if unit is not None and unit.suffix != DEGREES:
        parameters = _in_degrees(parameters, unit.suffix)
    known = {field.name: field for field in fields(chosen) if field.init}
    for name in parameters:
        if name not in known:
            raise unknown("trajectory parameter", str(name), known, f"kind '{kind}'")
    for name, field in known.items():
        if name not in parameters and field.default is MISSING and field.default_factory is MISSING:
            raise UsageError(f"trajectory.{name} is missing; kind '{kind}' needs it")
    return chosen(**parameters)


def _in_degrees(parameters: Mapping[str, Any], suffix: str) -> dict[str, Any]:
    """Return parameters with names in a unit as names in deg: ``amplitude_mm`` takes the place of ``amplitude_deg``."""
    found: dict[str, Any] = {}
    for name, value in parameters.items():
        if name == "segments" and isinstance(value, Sequence) and not isinstance(value, str):
            value = [_in_degrees(one, suffix) if isinstance(one, Mapping) else one for one in value]
        if name.endswith(f"_{suffix}"):
            name = f"{name[: -len(suffix) - 1]}_{DEGREES}"
        elif name.endswith(f"_{DEGREES}"):
            wanted = f"{name[: -len(DEGREES) - 1]}_{suffix}"
            if wanted in parameters:
                continue
            if value != 0.0:
                raise UsageError(f"trajectory.{name}: this plant's trajectory is in {suffix}; write {wanted}=VALUE")
        found.setdefault(name, value)
    return found


def find_kinds(folders: Sequence[Path] = ()) -> dict[str, type[Trajectory]]:
    """Return kind name -> class, from this folder and then from ``folders`` (a folder that is not there is empty).

    A file's name is the kind's name. `UsageError` where a user's file cannot be read, holds no kind, or takes the name
    of another.
    """
    kinds = dict(_own_kinds())
    for folder in folders:
        for path in _files(Path(folder)):
            found = _classes_of(load_module(path))
            if not found:
                raise UsageError(f"{path} defines no trajectory: a class that inherits hjcamp.trajectories.Trajectory")
            if path.stem in kinds:
                raise UsageError(f"{path}: the trajectory kind '{path.stem}' is already there; choose another name")
            kinds[path.stem] = found[0]
    return kinds


@lru_cache(maxsize=1)
def _own_kinds() -> dict[str, type[Trajectory]]:
    modules = (importlib.import_module(f"{__package__}.{path.stem}") for path in _files(OWN_FOLDER))
    return {found[0].kind: found[0] for found in map(_classes_of, modules) if found}


def _files(folder: Path) -> Iterable[Path]:
    return sorted(path for path in folder.glob("*.py") if not path.name.startswith("_"))


def _classes_of(module: ModuleType) -> list[type[Trajectory]]:
    return [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Trajectory) and value.__module__ == module.__name__
        if value is not Trajectory
    ]
