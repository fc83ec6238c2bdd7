"""Backends: what turns a resolved configuration and a seed into the columns of one test log."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import unknown
from hjcamp.known_plants import plant_of
from hjcamp.model.checks.watch import Watch, plausible_watches

BACKENDS = ("simulation", "nidaqmx", "rig")


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """Run one test on the configured backend; return the columns of its log and further metadata."""
    columns, notes = _backend(config).run_test(config, seed)
    return columns, notes


def notices(config: Mapping[str, Any]) -> list[str]:
    """Return what a person must know of this backend before a run, such as a rig without a watchdog."""
    say = getattr(_backend(config), "notices", None)
    return [] if say is None else list(say(config))


def before_moving(config: Mapping[str, Any]) -> list[str]:
    """Return the same at the start of a run; raises ``UsageError`` where nothing must move."""
    say = getattr(_backend(config), "before_moving", None)
    return [] if say is None else list(say(config))


def watches(config: Mapping[str, Any], reach: bool = False) -> list[Watch]:
    """Return the limits that a test stays within, as quantities of its log: those of its rig, else what its plant finds plausible.

    With ``reach`` the ranges of a rig's channels count as well: what an output gives, and what a sensor shows.
    """
    plant = plant_of(config)
    own = plant.room_of("watches")
    if own is not None and config["rig"].get("limits"):
        return list(own.rig_watches(config))
    if config["backend"]["name"] == "rig":
        return list(_backend(config).watches(config, reach))
    return plausible_watches(plant)


def kernel_texts(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return what a test compiles: in words -> its text and its last function."""
    return dict(_backend(config).kernel_texts(config))


def compile_ahead(config: Mapping[str, Any]) -> None:
    """Compile what a test on a rig needs, before anything moves; raises ``HjcampError`` where there is no rig."""
    _backend(config).compile_ahead(config)


def look_again(config: Mapping[str, Any], left: Any) -> str:
    """Look at a rig that was made safe by a fault; return what was found, raise ``HjcampError`` where it is not fit.

    ``left`` comes with the ``RigFault`` of the test that was stopped.
    """
    return str(_backend(config).look_again(config, left))


def _backend(config: Mapping[str, Any]) -> Any:
    name = config["backend"]["name"]
    if name not in BACKENDS:
        raise unknown("backend", name, BACKENDS)
    plant = plant_of(config)
    if name == "simulation" and name not in plant.rooms:
        from hjcamp.backends import plant_simulation

        return plant_simulation
    if name == "rig":
        from hjcamp.backends.rig.any_plant import backend

        return backend
    return plant.own_room(name)
