"""Further pictures for the report of a run: identification, design, sweeps, force steps, maps of two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hjcamp.campaign.design_pictures import DESIGN, design_pictures
from hjcamp.campaign.identification import identification_pictures
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.frequency_response import bode_charts, points_of
from hjcamp.plants.pump_joint.calibrate.static_stiffness import steps_of, stiffness_charts
from hjcamp.records.find import tell
from hjcamp.records.log import TestLog
from hjcamp.report.identification_figures import draw_chart
from hjcamp.report.indicators import configuration, indicators_of
from hjcamp.report.map_figure import draw_map
from hjcamp.report.published.configurations import leaves

SWEEP = "bandwidth"
STIFFNESS = "stiffness"
#: What a map shows, with its unit.
MAPPED = {"rmse1_deg": "RMSE1 (deg)", "pressure_low_mpa": "lowest line pressure (MPa gauge)"}
FEWEST = 3  # values of a parameter that make an axis


def study_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return heading -> (SVG, caption) of every further picture that the logs of a run give."""
    return {
        **identification_pictures(logs),
        **_of_design(logs),
        **sweep_pictures(logs),
        **stiffness_pictures(logs),
        **map_pictures(logs),
    }


def sweep_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return the Bode figure of the logs of a campaign ``bandwidth``; none for other logs."""
    own = [log for log in logs if log.metadata.get("campaign") == SWEEP]
    if not own:
        return {}
    try:
        said, charts = bode_charts(points_of(own, _configurations(own)))
    except UsageError as problem:
        return _without(SWEEP, problem)
    except KeyError:
        return {}
    return {chart.caption: (draw_chart(chart), said) for chart in charts}


def stiffness_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return force over travel and the largest angles of a campaign ``stiffness``; none for other logs."""
    own = [log for log in logs if log.metadata.get("campaign") == STIFFNESS]
    if not own:
        return {}
    try:
        said, charts = stiffness_charts(steps_of(own, _configurations(own)))
    except UsageError as problem:
        return _without(STIFFNESS, problem)
    except KeyError:
        return {}
    return {chart.caption: (draw_chart(chart), said) for chart in charts}


def map_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return a map for each of `MAPPED` where two numbers vary on a whole grid and nothing else does; else none."""
    configurations = _configurations(logs)
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
    pictures = {}
    for name, cells in found.items():
        values = np.array([[np.mean(cells.get((one, other), [np.nan])) for one in x] for other in y])
        if np.isfinite(values).any():
            svg = draw_map(MAPPED[name], (x_name, x), (y_name, y), values)
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


def _without(campaign: str, problem: UsageError) -> dict[str, tuple[str, str]]:
    """Say why a report has no picture of its campaign."""
    tell(f"no picture of '{campaign}': {problem}")
    return {}


def _of_design(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    own = [log for log in logs if log.metadata.get("campaign") == DESIGN]
    if not own:
        return {}
    try:
        return design_pictures(own, _configurations(own))
    except (UsageError, KeyError):
        return {}


def _configurations(logs: Sequence[TestLog]) -> dict[str, dict[str, Any]]:
    return {log.condition_key: configuration(log.attachments.get("config.yaml", b"")) for log in logs}
