"""The printed constants, the refitted ones and the measurement side by side, for conditions of chapter 5."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

import polars as pl

from hjcamp.plants.pump_joint.published.values import cell_key
from hjcamp.report.sheet import TITLES, Cell, Sheet

#: The answer of the diagnosis from which model `refit` was saved: written by `make thesis_gap`, never by hand.
VALUES = Path(__file__).with_name("refit.json")
SHOWN = ("rmse1_deg", "rmse2_deg", "e_max_deg")
WHY = (
    "Why the printed constants hunt: static friction is 1.4 times Coulomb friction, so every breakaway releases a push that "
    "the lines have stored, and the printed viscous friction is too small to brake the jump: the arm overshoots, sticks and "
    "winds the loop up again, the more with a payload. Where a motion turns back, the integral of the errors is multiplied with "
    "another gain from one sample to the next, which kicks the arm as well (controller.bumpless=1: without that kick). The "
    "refitted constants have more viscous friction and half the feedforward; what these stand for is open (docs/thesis_gap.md)."
)


@lru_cache(maxsize=1)
def refitted_means() -> dict[tuple[str, ...], float]:
    """Return the means of model `refit`, deg, by the choices of a published cell and the indicator; empty without a file."""
    if not VALUES.exists():
        return {}
    found = _answer()
    model = list(found["models"])[-1]
    rows = [*found["cells"], *found["cells_held_out"]]
    return {(*cell_key(row["choices"]), row["indicator"]): float(row["simulated"][model]) for row in rows}


def beside_refit(conditions: pl.DataFrame) -> Sheet | None:
    """Return the frame of `hjcamp.report.tables.by_condition` beside the refitted means; None where nothing compares."""
    found, body = refitted_means(), []
    for row in conditions.iter_rows(named=True):
        cells = [_cells(row, found.get((*cell_key(row), name)), name) for name in SHOWN]
        if all(cells):
            body.append([Cell(str(row["condition"]), "key"), *(cell for three in cells for cell in three)])
    if not body:
        return None
    headers = ["condition", *(text for name in SHOWN for text in (TITLES[name], "refitted", "published"))]
    notes = [
        "In deg. First: simulated in this run with the printed constants. Refitted: model refit, five tests with the first of these "
        f"seeds, simulated when it was fitted to {_tables()} alone. Published: measured on the real joint.",
        WHY,
    ]
    return Sheet("refitted", "As printed, refitted, measured", "", headers, body, notes)


def _tables() -> str:
    return " and ".join(f"Table {name}" for name in _answer()["tables"])


def _answer() -> dict[str, Any]:
    return dict(json.loads(VALUES.read_text(encoding="utf-8")))


def _cells(row: dict[str, Any], refitted: float | None, name: str) -> list[Cell]:
    simulated, measured = row.get(f"{name}_mean"), row.get(f"{name}_published_mean")
    if simulated is None or measured is None or refitted is None:
        return []
    return [Cell(f"{simulated:.2f}"), Cell(f"{refitted:.2f}"), Cell(f"{measured:.1f}", "published")]
