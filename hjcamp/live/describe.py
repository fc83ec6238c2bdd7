"""What the page must know of a test: the channels of its plant in panels, the names of its phases, its limits."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from hjcamp import backends
from hjcamp.controllers.fit import controlled_field
from hjcamp.errors import UsageError
from hjcamp.known_plants import plant_of
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import FieldTable, fields_of
from hjcamp.report.pages.exploration import NOT_CHANNELS, references
from hjcamp.report.wording.channels import channel_label, described

PHASE = re.compile(r"(\d+) ([^,;]+)")


def describe(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return plain values for a resolved configuration: ``period`` in s, ``phases``, ``channels`` with panels, ``watches``.

    What is controlled and what is wanted of it share the first panel; the others share one for each unit.
    """
    plant = plant_of(config)
    table = fields_of(plant)
    return {
        "plant": plant.name,
        "period": plant.period,
        "phases": phases_of(table),
        "channels": channels_of(plant, table),
        "watches": [_plain(asdict(one)) for one in backends.watches(config)],
    }


def nothing_known() -> dict[str, Any]:
    """Return the description of a test of which only its name is known."""
    return {"plant": "", "period": 1e-3, "phases": {}, "channels": [], "watches": []}


def phases_of(table: FieldTable) -> dict[str, str]:
    """Return the names of the phases by number, as the plant's field ``phase`` explains them."""
    return dict(PHASE.findall(table.field("phase").text)) if "phase" in table.names else {}


def channels_of(plant: type[Plant], table: FieldTable) -> list[dict[str, Any]]:
    """Return each channel of a plant's logs with ``name``, ``label``, ``unit``, ``panel`` and whether it is ``wanted``."""
    names = [name for name in table.names if name not in NOT_CHANNELS]
    followed = controlled_field(plant)
    # by the rule of names alone, so their values do not matter
    wanted = {name for name in names if followed in references(dict.fromkeys((name, followed), np.empty(0)))}
    found = []
    for name in names:
        told = described(name, f"plant {plant.name}")
        panel = "" if name == followed or name in wanted else told["unit"] or "1"
        found.append({**told, "panel": panel, "wanted": name.startswith("reference_")})
    return sorted(found, key=lambda one: one["panel"] != "")


def _label(name: str) -> str:
    """Return the name of a limit as people read it: ``arm_speed_deg_per_s`` is ``arm speed``; its unit stands with its number."""
    try:
        return channel_label(name)
    except UsageError:
        return name.replace("_", " ")


def _plain(watch: dict[str, Any]) -> dict[str, Any]:
    """JSON has no infinity: what has no end is None."""
    watch["label"] = _label(watch["name"])
    watch["phases"] = [None if abs(end) == float("inf") else end for end in watch["phases"]]
    return watch
