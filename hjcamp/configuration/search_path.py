"""Where configuration and campaigns are looked for: the user's own folders first, then those that came with hjcamp."""

from __future__ import annotations

from pathlib import Path

import hjcamp
from hjcamp.model.files.user_folders import user_folders


def packaged_root() -> Path:
    """Return the folder of our own ``conf/`` and ``campaigns/``: that of the installed wheel, else of the checkout."""
    package = Path(hjcamp.__file__).resolve().parent
    installed = package / "_configuration"
    return installed if installed.is_dir() else package.parent


def configuration_folders() -> list[Path]:
    """Return the folders of Hydra groups of the user, first wins, without our own."""
    found = []
    for folder in user_folders():
        if (folder / "conf").is_dir():
            found.append(folder / "conf")
        elif folder != Path.cwd() and folder.is_dir():
            found.append(folder)
    return _others(found, packaged_root() / "conf")


def campaign_folders() -> list[Path]:
    """Return the folders of campaign files of the user, first wins, without our own."""
    found = []
    for folder in user_folders():
        found.append(folder / "campaigns")
        if folder.name == "conf":
            found.append(folder.parent / "campaigns")
    return _others([folder for folder in found if folder.is_dir()], packaged_root() / "campaigns")


def group_folders(group: str) -> list[Path]:
    """Return every folder with files of a group (``table``), the user's before our own."""
    folders = [folder / group for folder in (*configuration_folders(), packaged_root() / "conf")]
    return [folder for folder in folders if folder.is_dir()]


def _others(folders: list[Path], own: Path) -> list[Path]:
    unique = dict.fromkeys(folder.resolve() for folder in folders)
    unique.pop(own.resolve(), None)
    return list(unique)
