"""Controllers: one control law is one file of this folder, or of the user's own ``controllers`` folder."""

from __future__ import annotations

from pathlib import Path

from hjcamp.controllers.controller import Controller
from hjcamp.errors import unknown
from hjcamp.model.catalogue import scan
from hjcamp.model.user_folders import extension_folders


def load_controllers() -> dict[str, type[Controller]]:
    """Return every controller by name, ours and the user's."""
    return scan(Path(__file__).parent, __name__, Controller, extension_folders("controllers"))


def find_controller(name: str) -> type[Controller]:
    """Return the controller called ``name``."""
    controllers = load_controllers()
    if name not in controllers:
        raise unknown("controller", name, controllers)
    return controllers[name]
