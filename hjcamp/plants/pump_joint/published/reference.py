"""What stands next to the tests of a report: printed values, where a test differs from theirs, the refitted means."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import polars as pl

from hjcamp.plants.pump_joint.published.values import CAMPAIGNS, CONDITION, MEASURED_WITH, cell_key, published_cells

if TYPE_CHECKING:
    from hjcamp.report.tables.sheet import Sheet

__all__ = ["CAMPAIGNS", "CONDITION", "MEASURED_WITH", "against_refit", "cell_key", "published_cells", "standing"]


def standing(config: Mapping[str, Any], cell: tuple[str, ...]) -> list[dict[str, str]]:
    """Return the tables that have a cell, and where a configuration differs from its test."""
    from hjcamp.plants.pump_joint.published import configurations

    return configurations.standing(config, cell)


def against_refit(conditions: pl.DataFrame) -> Sheet | None:
    """Return conditions next to the refitted means; None where nothing compares."""
    from hjcamp.plants.pump_joint.published import refitted

    return refitted.against_refit(conditions)
