"""Further pictures for the report of a run of this joint: identification, design, sweeps, force steps."""

from __future__ import annotations

from collections.abc import Sequence

from hjcamp.campaign.further_pictures import configurations_of
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.frequency_response import bode_charts, points_of
from hjcamp.plants.pump_joint.calibrate.static_stiffness import steps_of, stiffness_charts
from hjcamp.plants.pump_joint.figures.identification import draw_chart
from hjcamp.plants.pump_joint.studies.design_pictures import DESIGN, design_pictures
from hjcamp.plants.pump_joint.studies.identification import identification_pictures
from hjcamp.records.find import tell
from hjcamp.records.log import TestLog

SWEEP = "bandwidth"
STIFFNESS = "stiffness"


def study_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return heading -> (SVG, caption) of every further picture that the logs of a run of this joint give."""
    return {
        **identification_pictures(logs),
        **_of_design(logs),
        **sweep_pictures(logs),
        **stiffness_pictures(logs),
    }


def sweep_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return the Bode figure of the logs of a campaign ``bandwidth``; none for other logs."""
    own = [log for log in logs if log.metadata.get("campaign") == SWEEP]
    if not own:
        return {}
    try:
        said, charts = bode_charts(points_of(own, configurations_of(own)))
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
        said, charts = stiffness_charts(steps_of(own, configurations_of(own)))
    except UsageError as problem:
        return _without(STIFFNESS, problem)
    except KeyError:
        return {}
    return {chart.caption: (draw_chart(chart), said) for chart in charts}


def _without(campaign: str, problem: UsageError) -> dict[str, tuple[str, str]]:
    """Say why a report has no picture of its campaign."""
    tell(f"no picture of '{campaign}': {problem}")
    return {}


def _of_design(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    own = [log for log in logs if log.metadata.get("campaign") == DESIGN]
    if not own:
        return {}
    try:
        return design_pictures(own, configurations_of(own))
    except (UsageError, KeyError):
        return {}
