"""Controllers: one control law is one file of this folder, of a plant's, or of the user's own ``controllers`` folder."""

from __future__ import annotations

from pathlib import Path

from hjcamp.controllers.controller import Controller
from hjcamp.errors import unknown
from hjcamp.known_plants import folders_in_plants
from hjcamp.model.files.catalogue import scan
from hjcamp.model.files.user_folders import extension_folders


def load_controllers() -> dict[str, type[Controller]]:
    """Return every controller by name, ours and the user's."""
    of_plants: dict[str, type[Controller]] = {}
    for folder, package in folders_in_plants("controllers"):
        of_plants |= scan(folder, package, Controller)
    return scan(Path(__file__).parent, __name__, Controller, extension_folders("controllers"), of_plants)


def find_controller(name: str) -> type[Controller]:
    """Return the controller called ``name``."""
    controllers = load_controllers()
    if name not in controllers:
        raise unknown("controller", name, controllers)
    return controllers[name]
