"""Where the user's own files are looked for: one order for configuration, campaigns, effects and all others."""

from __future__ import annotations

import os
from pathlib import Path

ENVIRONMENT_VARIABLE = "HJCAMP_CONF"


def user_folders() -> list[Path]:
    """Return the user's folders, first wins: each of ``$HJCAMP_CONF``, then the working directory."""
    named = [Path(os.path.expanduser(part)) for part in os.environ.get(ENVIRONMENT_VARIABLE, "").split(os.pathsep) if part]
    return [*named, Path.cwd()]


def extension_folders(name: str) -> list[Path]:
    """Return the user's folders of that name (``effects``, ``trajectories``) that exist, first wins."""
    found = []
    for folder in user_folders():
        found.append(folder / name)
        if folder.name == "conf":
            found.append(folder.parent / name)
    return list(dict.fromkeys(folder.resolve() for folder in found if folder.is_dir()))
