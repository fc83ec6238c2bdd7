"""The map of what a model lacks: of the subsystem that is to blame first, all maps of one quantity on one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.compare import Compared
    from hjcamp.plants.pump_joint.figures.discrepancy import Map

CAPTIONS = {
    "joint": "Force on the sliding arm that the model lacks, over speed and angle",
    "lines": "Flow out of both lines that the model lacks, over the pump's speed and the pressures",
}
PALE_SAID = "One colour scale for all maps of this quantity. Pale: not more than twice its standard error from test to test."


def maps_of(models: Sequence[Compared]) -> dict[str, tuple[str, str]]:
    """Return the caption and the drawing of each model's map, by its name, with its bars."""
    from hjcamp.plants.pump_joint.answers.where_words import grouped_bars
    from hjcamp.plants.pump_joint.figures.discrepancy import draw_map, largest

    kinds = {one.replay.name: blamed(one) for one in models}
    most = {kind: max(largest(map_of(one, kind)) for one in models) for kind in set(kinds.values())}
    found = {}
    for one in models:
        kind = kinds[one.replay.name]
        bars = grouped_bars([place.row() for place in one.places])
        found[one.replay.name] = CAPTIONS[kind], draw_map(map_of(one, kind), bars, most[kind])
    return found


def blamed(one: Compared) -> str:
    """Return the subsystem that is to blame first, of those that have a map; the joint where neither is."""
    return next((place.subsystem for place in one.places if place.variable == "all" and place.subsystem in CAPTIONS), "joint")


def map_of(one: Compared, kind: str) -> Map:
    """Return the missing force (N) over speed (mm/s) and angle (deg), or the missing flow (mm3/s) over speed and pressure (MPa)."""
    import numpy as np

    from hjcamp.plants.pump_joint.diagnosis.localisation.where import SLIDING, UNITS, quantities
    from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
    from hjcamp.plants.pump_joint.figures.discrepancy import Map

    evidence = one.replay.evidence
    if kind == "joint":
        slides = evidence.sliding
        of_test = np.repeat(np.arange(len(evidence.tests)), np.diff(evidence.edges))
        # The residual is push less friction: a force on the arm that the model lacks has the other sign.
        return Map(
            evidence.joined("velocity")[slides] * 1e3, one.replay.measured[slides, 0], -one.residuals[slides, SLIDING], of_test[slides],
            "Speed of the sliders (mm/s)", "Arm angle (deg)", "Missing force (N)",
        )  # fmt: skip
    features = Features(evidence)
    flow = quantities(features, one.seen)[2]
    stiffness = evidence.tests[0].hardware.values["line_stiffness"]
    x, y = (flow.drivers[name][flow.valid] * UNITS[name][1] for name in ("pump_velocity", "pressure_sum"))
    return Map(
        x, y, 1e9 * flow.values[flow.valid] / stiffness, features.of_test[flow.valid],
        "Speed of the pump (mm/s)", "Sum of the pressures (MPa)", "Missing flow (mm3/s)",
    )  # fmt: skip
