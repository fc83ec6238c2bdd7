"""The plants by name: one file (or folder) each, ours in ``hjcamp/plants`` and the user's in a folder ``plants``; there is no list."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.catalogue import class_in, files_in, scan, scan_files
from hjcamp.model.files.user_folders import extension_folders

DEFAULT = "pump_joint"
PACKAGE = "hjcamp.plants"
OWN_PLANTS = Path(__file__).parent / "plants"


def load_plants(folders: Sequence[Path] | None = None) -> dict[str, type[Plant]]:
    """Return every plant by name, ours and the user's; a faulty file is refused, saying what is allowed."""
    chosen = extension_folders("plants") if folders is None else list(folders)
    return scan(OWN_PLANTS, PACKAGE, Plant, chosen)


def usual_plant() -> type[Plant]:
    """Return the plant of logs and configurations that name none; no other plant's file is looked at."""
    found = class_in(OWN_PLANTS / DEFAULT / "plant.py", Plant, f"{PACKAGE}.{DEFAULT}", DEFAULT)
    assert found is not None
    return found


def folders_in_plants(name: str) -> list[tuple[Path, str]]:
    """Return the folders called ``name`` of our plants, each with its package: ``plants/PLANT/controllers``."""
    return [(folder, f"{PACKAGE}.{folder.parent.name}.{name}") for folder in sorted(OWN_PLANTS.glob(f"*/{name}"))]


def plant_names(folder: Path) -> list[str]:
    """Return the plants of a folder by name; a user's files are not run for it."""
    if folder == OWN_PLANTS:
        return sorted(load_plants([]))
    return sorted({name for name, _ in files_in(folder, "plant.py")})


def find_plant(name: str = DEFAULT, where: str = "", folders: Sequence[Path] | None = None) -> type[Plant]:
    """Return the plant called ``name``; ``where`` says what names it. Raises ``UsageError`` with the nearest match.

    No other file of the user's is run: a fault in it is no fault of this plant.
    """
    chosen = extension_folders("plants") if folders is None else list(folders)
    ours = scan(OWN_PLANTS, PACKAGE, Plant)
    files = [(own, path) for folder in chosen for own, path in files_in(folder, "plant.py")]
    wanted = [path for own, path in files if own == name]
    if not wanted:
        if name not in ours:
            problem = unknown("plant", name, sorted({*ours, *(own for own, _ in files)}), where)
            # whoever has one of that name called from another folder
            raise problem if files else UsageError(f"{problem}. Your own are looked for in ./plants, where none is")
        return ours[name]
    return scan_files([(name, path) for path in wanted], "plant.py", Plant, ours)[name]


def plants_and_faults() -> tuple[dict[str, type[Plant]], dict[str, str]]:
    """Return every plant by name, and what is wrong with the files of the user's that hold none, or one without sound equations."""
    from hjcamp.model.language.vocabulary import read_vocabulary

    found, faults = scan(OWN_PLANTS, PACKAGE, Plant), {}
    for folder in extension_folders("plants"):
        for name, path in files_in(folder, "plant.py"):
            try:
                more = scan_files([(name, path)], "plant.py", Plant, found)
                read_vocabulary(more[name])
                found = more
            except UsageError as problem:
                faults[name] = str(problem)
    return found, faults


def plant_called(name: str, where: str = "") -> type[Plant]:
    """Return the plant called ``name``; for the usual one no other plant's file is run."""
    return usual_plant() if name == DEFAULT else find_plant(name, where)


def plant_of(config: Mapping[str, Any]) -> type[Plant]:
    """Return the plant of a resolved configuration; the usual one where it names none."""
    return plant_called(str((config.get("plant") or {}).get("name") or DEFAULT), "plant")
