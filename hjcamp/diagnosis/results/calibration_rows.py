"""Rows of an answer that stand for base parameters: as declared, and as the tests have them."""

from __future__ import annotations

from typing import Any

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.decision.free_curve import mean_over_knots
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.base_values import DELAY


def calibration(analysis: Analysis, model: Scored | None = None) -> dict[str, dict[str, Any]]:
    """Return every base parameter: as declared, and as these tests have it; and how far contacts give way, where that is seen.

    So the base has it by itself, or with what a ``model`` has found: an additive law's curve is drawn for that, one of a parameter
    about its mean over the knots. What the model had before, its effects, is fitted again with it.
    """
    plant, found, had = analysis.measured.plant, {}, analysis.start.effects
    forms = {name: analysis.search.library[name] for name in analysis.base.names if name not in had}
    laws = [analysis.search.unknowns[name] for name in (model or analysis.base).names if name in analysis.search.unknowns]
    values = {one.place: one for one in laws if one.quantity == "value"}
    for one in intervals((model or analysis.base).fitted, analysis.search.blocks):
        if model and not one.effect and one.name in values:
            one = mean_over_knots(analysis, model, values[one.name], one)
        if one.effect in forms and one.name == forms[one.effect].granted:
            item = forms[one.effect].parameters[one.name]
            found[f"{one.effect} {one.name}"] = {
                "published": 0.0,
                "value": one.value,
                "unit": item.unit,
                **one.row,
            }
        if one.effect in had:
            unit = analysis.search.library[one.effect].parameters[one.name].unit
            found[f"{one.effect} {one.name}"] = {
                "published": had[one.effect][one.name],
                "value": one.value,
                "unit": unit,
                **one.row,
                "at_bound": one.at_bound,
            }
        if one.effect or one.name.startswith(ZERO):
            continue
        declared = 0.0 if one.name.startswith(DELAY) else plant.parameters[one.name].default
        unit = "s" if one.name.startswith(DELAY) else plant.parameters[one.name].unit
        found[one.name] = {
            "published": declared,
            "value": one.value,
            "unit": unit,
            **one.row,
            "at_bound": one.at_bound,
            **({"held": True} if model is None and one.name in analysis.held else {}),
        }
    return found
