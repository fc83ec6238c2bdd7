"""Rigs of any plant: one rig is one file of the user's own ``rigs`` folder, a class derived from one of those here."""

from __future__ import annotations

from pathlib import Path

from hjcamp.errors import UsageError, unknown
from hjcamp.model.files.catalogue import files_in, scan_files
from hjcamp.model.files.user_folders import extension_folders
from hjcamp.rigs.rig import Rig

OWN_RIGS = Path(__file__).parent
#: Rigs that need no file: the plant's own simulation in this process, and one that ``hjcamp rig serve`` serves.
SHIPPED = {
    "simulated": "the plant itself, simulated in this process, one sample for each read",
    "virtual": "a plant that `hjcamp rig serve plant=PLANT` serves on this computer",
}


def rig_names(folder: Path) -> list[str]:
    """Return the rigs of a folder by name; a user's files are not run for it."""
    return sorted({name for name, _ in files_in(folder, "rig.py")})


def find_rig(name: str, where: str = "rig") -> type[Rig]:
    """Return the user's rig called ``name``; no other file of the user's is run. Raises ``UsageError`` with the nearest match."""
    files = [(own, path) for folder in extension_folders("rigs") for own, path in files_in(folder, "rig.py")]
    wanted = [path for own, path in files if own == name]
    if not wanted:
        problem = unknown("rig", name, sorted({*SHIPPED, *(own for own, _ in files)}), where)
        raise problem if files else UsageError(f"{problem}. Your own are looked for in ./rigs, where none is")
    for path in wanted:
        if name in SHIPPED:
            raise UsageError(f"{path}: the name '{name}' is taken; choose another file name")
    return scan_files([(name, path) for path in wanted], "rig.py", Rig, {})[name]


def rigs_and_faults() -> tuple[dict[str, type[Rig]], dict[str, str]]:
    """Return every rig of the user's by name, and what is wrong with the files that hold none."""
    found: dict[str, type[Rig]] = {}
    faults: dict[str, str] = {}
    for name in dict.fromkeys(name for folder in extension_folders("rigs") for name in rig_names(folder)):
        try:
            found[name] = find_rig(name)
        except UsageError as problem:
            faults[name] = str(problem)
    return found, faults
