"""The published values that stand next to tests: those of the usual plant."""

from __future__ import annotations

from typing import Any

from hjcamp.known_plants import usual_plant

_VALUES: Any = usual_plant().own_room("published")
CONDITION: tuple[str, ...] = _VALUES.CONDITION
MEASURED_WITH: dict[str, str] = _VALUES.MEASURED_WITH
CAMPAIGNS: dict[str, tuple[str, ...]] = _VALUES.CAMPAIGNS
cell_key, published_cells, standing, against_refit = (
    _VALUES.cell_key,
    _VALUES.published_cells,
    _VALUES.standing,
    _VALUES.against_refit,
)
