"""The measured tables of the reference as data."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.plants.pump_joint.tables.cells import SIMULATED, Cells
from hjcamp.report.runs.indicators import INDICATORS
from hjcamp.report.runs.published import published_cells

#: What names a row of the printed tables; every other choice was the same in all measured tests.
KEYS = ("trajectory", "controller", "payload", "orientation")
#: Where each table was measured.
CAMPAIGNS = {
    "5.4.1": ("controllers",),
    "5.4.2": ("controllers",),
    "5.5.1": ("robustness_horizontal", "robustness_vertical"),
    "5.5.2": ("robustness_horizontal", "robustness_vertical"),
}
PRINTED_STEP = 0.1
PRINTED_TESTS = 7


def check_names(names: Sequence[str]) -> None:
    """Raise ``UsageError`` for a table that is not printed with means and deviations of measured tests."""
    for name in names:
        if name not in CAMPAIGNS:
            raise unknown("table", name, CAMPAIGNS, "the measured tables of the reference")
    if len(set(names)) < len(names):
        raise UsageError(f"--tables {' '.join(names)}: each table once")


def printed_cells(tables: Sequence[str]) -> Cells:
    """Return the cells of ``tables``; their deviations divide by n (`hjcamp.plants.pump_joint.published.consistency`)."""
    frame = published_cells().filter(published_cells()["table"].is_in(list(tables)))
    conditions: list[dict[str, str]] = []
    found: list[tuple[str, int, int, float, float, float]] = []
    for row in frame.iter_rows(named=True):
        place = {key: row[key] for key in KEYS}
        if place not in conditions:
            conditions.append(place)
        scatter = row["std"] * (PRINTED_TESTS / (PRINTED_TESTS - 1)) ** 0.5
        error = math.hypot(scatter / PRINTED_TESTS**0.5, PRINTED_STEP / 12**0.5)
        indicator = INDICATORS.index(row["indicator"])
        found.append((row["table"], conditions.index(place), indicator, row["mean"], error, scatter / SIMULATED**0.5))
    table, rows, columns, means, errors, simulated = zip(*found, strict=True)
    return Cells(
        table, conditions, np.array(rows), np.array(columns), np.array(means), np.array(errors), PRINTED_STEP, np.array(simulated)
    )  # fmt: skip


def campaigns_of(tables: Sequence[str]) -> tuple[str, ...]:
    """Return the campaigns in which ``tables`` were measured, each once."""
    return tuple(dict.fromkeys(name for table in tables for name in CAMPAIGNS[table]))
