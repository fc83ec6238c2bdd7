"""Further pictures for the report of a run: those of its plant, and maps of two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.report.pictures.map import draw_map
from hjcamp.report.runs.indicators import configuration, indicators_of
from hjcamp.report.runs.settings import leaves
from hjcamp.report.wording.names import axis

#: What a map shows, with its unit.
MAPPED = {
    "rmse1_deg": "RMSE1 (deg)",
    "pressure_low_mpa": "lowest line pressure (MPa gauge)",
    "above_0p58_s": "time in which the fittings leak, above 0.58 MPa gauge (s)",
}
FEWEST = 3  # values of a parameter that make an axis


def further_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return heading -> (SVG, caption) of every further picture that the logs of a run give."""
    room = plant_of(logs[0].metadata, str(logs[0].path)).room_of("run") if logs else None
    return {**(room.pictures(logs) if room else {}), **map_pictures(logs)}


def map_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return a map for each of `MAPPED` where two numbers vary on a whole grid and nothing else does; else none.

    What is 0 in every test has no map.
    """
    configurations = configurations_of(logs)
    flat = {name: dict(leaves(config, "")) for name, config in configurations.items()}
    axes = varied_numbers(flat)
    if axes is None or len(flat) != len(axes[0][1]) * len(axes[1][1]):
        return {}
    (x_name, x), (y_name, y) = axes
    found: dict[str, dict[tuple[float, float], list[float]]] = {name: {} for name in MAPPED}
    for log in logs:
        row, place = indicators_of(log), flat[log.condition_key]
        for name, cells in found.items():
            if row[name] is not None:
                cells.setdefault((place[x_name], place[y_name]), []).append(row[name])
    happened = {name: cells for name, cells in found.items() if any(map(any, cells.values()))}
    pictures = {}
    for name, cells in happened.items():
        values = np.array([[np.mean(cells.get((one, other), [np.nan])) for one in x] for other in y])
        if np.isfinite(values).any():
            svg = draw_map(MAPPED[name], (axis(x_name), x), (axis(y_name), y), values)
            pictures[f"Map of {MAPPED[name]}"] = svg, f"mean of the repetitions over {x_name} and {y_name}"
    return pictures


def varied_numbers(flat: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, list[float]]] | None:
    """Return the two parameters that vary, with their values; None where it is not two numbers of three values or more."""
    keys = dict.fromkeys(key for one in flat.values() for key in one)
    varied = []
    for key in keys:
        values = [one.get(key) for one in flat.values()]
        if any(value != values[0] for value in values[1:]):
            if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
                return None
            varied.append((key, sorted({float(value) for value in values if value is not None})))
    return varied if len(varied) == 2 and all(len(values) >= FEWEST for _, values in varied) else None


def configurations_of(logs: Sequence[TestLog]) -> dict[str, dict[str, Any]]:
    """Return the configuration in the logs of each condition, by the condition's key."""
    return {log.condition_key: configuration(log.attachments.get("config.yaml", b"")) for log in logs}
