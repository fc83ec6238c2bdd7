"""What a log's metadata say of its plant and of the time between its samples."""

from __future__ import annotations

from collections.abc import Mapping

from hjcamp.errors import UsageError
from hjcamp.known_plants import DEFAULT, plant_called
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import FieldTable, fields_of

PLANT_KEY, PERIOD_KEY = "plant", "period_s"
USUAL_PERIOD_S = 1e-3
LONGEST_PERIOD_S = 86400.0


def plant_of(metadata: Mapping[str, str], where: str) -> type[Plant]:
    """Return the plant of a log: that of its metadata, else the usual one. Raises ``UsageError`` with the nearest match."""
    return plant_called(metadata.get(PLANT_KEY) or DEFAULT, where)


def table_of(metadata: Mapping[str, str], where: str) -> FieldTable:
    """Return the field table of a log by its metadata; raises ``UsageError`` for a plant that is not known."""
    return fields_of(plant_of(metadata, where))


def period_of(metadata: Mapping[str, str], where: str) -> float:
    """Return the time between samples, s, by a log's metadata, 1 ms where they do not say; raises ``UsageError``."""
    text = metadata.get(PERIOD_KEY)
    if text is None:
        return USUAL_PERIOD_S
    try:
        period = float(text)
    except ValueError:
        period = 0.0
    if not 0.0 < period <= LONGEST_PERIOD_S:
        raise UsageError(
            f"{where}: {PERIOD_KEY} of its metadata is {text!r:.40}; a number above 0 and up to {LONGEST_PERIOD_S:g} is needed"
        )
    return period


def span(seconds: float) -> str:
    """Return a short time in words: in ms below a second."""
    return f"{seconds * 1e3:.4g} ms" if seconds < 1.0 else f"{seconds:.4g} s"
