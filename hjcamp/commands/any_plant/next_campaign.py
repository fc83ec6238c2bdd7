"""The proposed tests of any plant as a campaign, where `hjcamp run` can make them: one input is given, all others rest."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.analyses.data import Data, joined

if TYPE_CHECKING:
    from hjcamp.analyses.proposing import PlantProposed
    from hjcamp.diagnosis.design.proposal import Proposed

# A step of an input takes a thousandth of a sample: between two samples it is a jump.
JUMP = 1e-3


def written_campaign(done: PlantProposed, data: Data, name: str | None) -> Path | None:
    """Write the proposed tests as ``campaigns/NAME.yaml`` and return it; None where `hjcamp run` cannot make all of them."""
    from hjcamp.campaign.plan.new_file import new_campaign, write_campaign
    from hjcamp.commands.any_plant.next_answer import names_of

    tests = done.proposal.tests[: done.proposal.chosen]
    plant = done.analysis.measured.plant
    driven = {one.wanted.driven for one in tests}
    if len(driven) != 1 or not all(one.wanted.pieces for one in tests) or not _others_rest(done, *driven):
        return None
    path = new_campaign(name)
    content = {
        "name": path.stem,
        "description": f"Tests that set apart {names_of(done.proposal)}",
        "fixed": {"plant": plant.name, "controller": "given", "controller.input": next(iter(driven))},
        "vary": {"test": {one.wanted.name: settings_of(done, one) for one in tests}},
        "repetitions": max(tests[0].repetitions, 1),
        "tables": [],
    }
    comment = [f"Proposed by hjcamp next from {joined(data.paths)}, in simulation: parameters=... makes it this rig."]
    write_campaign(path, content, comment)
    return path


def _others_rest(done: PlantProposed, driven: str) -> bool:
    """Whether every other input is at its default in the proposed tests."""
    plant = done.analysis.measured.plant
    names = [name for name in plant.inputs if name not in ("time", "direction")]
    tests = done.proposal.tests[: done.proposal.chosen]
    return all(
        np.all(one.wanted.inputs[:, k] == plant.inputs[name].default)
        for one in tests
        for k, name in enumerate(names)
        if name != driven
    )


def settings_of(done: PlantProposed, one: Proposed) -> dict[str, Any]:
    """Return what a condition of `hjcamp run` says for a course of one input: trajectory, and where the states begin."""
    from hjcamp.controllers.fit import input_field
    from hjcamp.model.language.field_unit import unit_of_field

    plant = done.analysis.measured.plant
    unit = unit_of_field(input_field(plant, one.wanted.driven), f"plant {plant.name}")
    segments: list[dict[str, Any]] = []
    for value, seconds in one.wanted.pieces:
        jump = JUMP * plant.period if JUMP * plant.period >= 1e-3 else 1e-3
        segments.append({f"to_{unit.suffix}": round(value * unit.scale, 9), "in": jump, "law": "linear"})
        segments.append({"rest": round(seconds - jump, 9)})
    drawn = done.proposal.truths[0][0]
    start = drawn.starts[np.flatnonzero(drawn.layout.of_test == one.place)[0]]
    return {
        "trajectory": "segments",
        "trajectory.segments": segments,
        **{f"start.{name}": float(f"{value:.7g}") for name, value in zip(plant.states, start, strict=True)},
    }
