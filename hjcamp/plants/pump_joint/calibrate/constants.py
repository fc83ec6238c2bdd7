"""What an identification must know beforehand: bores, lead, pulley, tubing; read from a log's own configuration."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.known_plants import usual_plant
from hjcamp.plants.pump_joint.hardware import transfer_function
from hjcamp.records.log import TestLog
from hjcamp.yaml_file import yaml_values

Names = tuple[tuple[str, str], ...]
Configure = Callable[[Names], Mapping[str, Any]]
NAMED = usual_plant().rig
NEEDED = ("pump", "amplifier", "tubing", "joint", "friction", "rig")


@dataclass(frozen=True)
class Constants:
    """Known geometry of a rig in SI units, and the published values to stand next to what is identified."""

    pump: str
    amplifier: str
    pump_area: float
    pump_lead: float
    joint_area: float
    pulley_radius: float
    pump_speed_limit: float
    tubing: Mapping[str, Any]
    published: Mapping[str, float]
    published_delay: float


def hardware_of(log: TestLog) -> Names:
    """Return the pump, amplifier and tubing that the log's metadata name; an absent one is left out."""
    return tuple((group, log.metadata[group]) for group in NAMED if log.metadata.get(group))


def constants_of(log: TestLog, configure: Configure) -> Constants:
    """Return the constants of the rig that made ``log``.

    Geometry comes from the log's attachment ``config.yaml``, else from the choices that its metadata name, else from
    the reference setup. ``configure`` gives the resolved configuration of choices (group, choice).
    """
    reference = configure(hardware_of(log))
    return _constants(attached_configuration(log) or reference, reference)


def attached_configuration(log: TestLog) -> Mapping[str, Any] | None:
    """Return the resolved configuration attached to a log, None where there is none that is whole."""
    content = log.attachments.get("config.yaml")
    return None if content is None else _parsed(content)


@functools.lru_cache(maxsize=64)
def _parsed(content: bytes) -> Mapping[str, Any] | None:
    try:
        config = yaml_values(content)
    except UsageError:
        return None
    whole = isinstance(config, Mapping) and all(isinstance(config.get(group), Mapping) for group in NEEDED)
    return config if whole else None


def _constants(config: Mapping[str, Any], reference: Mapping[str, Any]) -> Constants:
    try:
        own = usual_plant().configured(config)
    except (KeyError, TypeError, ValueError) as problem:
        raise UsageError(f"a log's config.yaml does not describe its hardware: {problem!r}") from None
    return Constants(
        config["pump"]["name"],
        config["amplifier"]["name"],
        own["pump_area"],
        own["pump_lead"],
        own["joint_area"],
        own["pulley_radius"],
        own["pump_speed_limit"],
        dict(config["tubing"]),
        usual_plant().configured(reference),
        float(transfer_function(reference)["delay_ms"]) * 1e-3,
    )


def pump_travel(degrees: Any, constants: Constants) -> Any:
    """Return the travel of the pump pistons in m for angles of the pump motor in deg (thesis 3.8)."""
    return degrees * (math.pi / 180.0) * constants.pump_lead
