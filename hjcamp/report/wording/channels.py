"""Names of channels as people read them."""

from __future__ import annotations

from typing import Any

from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.report.wording.units import label


def described(channel: str, where: str) -> dict[str, Any]:
    """Return name, label and unit of a channel as people read them; a name without a unit is refused."""
    unit = unit_of_field(channel, where)
    said = label(channel)
    return {
        "name": channel,
        "label": label(channel.removesuffix(f"_{unit.suffix}")) if said == channel.replace("_", " ") else said,
        "unit": "" if unit.shown == "1" else unit.shown,
    }


def channel_label(channel: str) -> str:
    """Return the name of a channel as people read it, without its unit: ``position_m`` is ``position``."""
    return str(described(channel, "a channel")["label"])
