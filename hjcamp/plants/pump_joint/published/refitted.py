"""The printed constants, the refitted ones and the measurement side by side, for conditions of chapter 5."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

import polars as pl

from hjcamp.plants.pump_joint.published.values import cell_key
from hjcamp.report.tables.sheet import TITLES, Cell, Sheet

#: The answer of the diagnosis from which model `refit` was saved: written by `make thesis_gap`, never by hand.
VALUES = Path(__file__).with_name("refit.json")
SHOWN = ("rmse1_deg", "rmse2_deg", "e_max_deg")
REST = (
    "The arm overshoots, sticks and winds the loop up again, the more with a payload. Where a motion turns back, the integral of "
    "the errors is multiplied with another gain from one sample to the next, which kicks the arm as well (controller.bumpless=1: "
    "without that kick). What the refitted constants stand for is open (docs/thesis_gap.md in the sources)."
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


def against_refit(conditions: pl.DataFrame) -> Sheet | None:
    """Return the frame of `hjcamp.report.tables.aggregation.by_condition` next to the refitted means; None where nothing compares."""
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
        f"{_why()} {_nearer(body)}",
        REST,
    ]
    return Sheet("refitted", "As printed, refitted, measured", "", headers, body, notes)


def _why() -> str:
    """Return why the printed constants hunt and by what they are mended, in the numbers of the fit."""
    found = _answer()
    fitted = found["models"][list(found["models"])[-1]]["quantities"]
    printed, viscous, feedforward = (fitted[name] for name in ("drop_positive", "viscous_positive", "feedforward_gain"))
    return (
        f"Why the printed constants hunt: static friction is {printed['published']:.1f} times Coulomb friction, so every breakaway "
        f"releases a push that the lines have stored, and viscous friction of {viscous['published']:.0f} N s/m is too small to brake "
        f"it; the refitted constants have {viscous['value']:.0f} N s/m and {feedforward['value']:.2f} of the feedforward."
    )


def _nearer(body: list[list[Cell]]) -> str:
    """Return how far the first indicator is from the measured means with either constants."""
    rows = [[float(cell.text) for cell in row[1:4]] for row in body]
    before, after = ([abs(row[place] - row[2]) for row in rows] for place in (0, 1))
    nearer = sum(one < other for one, other in zip(after, before, strict=True))
    return (
        f"{TITLES[SHOWN[0]]} is off by {sum(before) / len(rows):.2f} deg on average as printed and by {sum(after) / len(rows):.2f} deg "
        f"refitted, which is nearer in {nearer} of {len(rows)} conditions."
    )


def _tables() -> str:
    return " and ".join(f"Table {name}" for name in _answer()["tables"])


def _answer() -> dict[str, Any]:
    return dict(json.loads(VALUES.read_text(encoding="utf-8")))


def _cells(row: dict[str, Any], refitted: float | None, name: str) -> list[Cell]:
    simulated, measured = row.get(f"{name}_mean"), row.get(f"{name}_published_mean")
    if simulated is None or measured is None or refitted is None:
        return []
    return [Cell(f"{simulated:.2f}"), Cell(f"{refitted:.2f}"), Cell(f"{measured:.1f}", "published")]
