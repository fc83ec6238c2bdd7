"""What the tests of any plant say of every fitted parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hjcamp.commands.any_plant.verdict_words import Words
    from hjcamp.commands.shared.corner import Estimate


def fitted_parameters(words: Words) -> tuple[list[Estimate], Any]:
    """Return every fitted parameter of the model found, and how the curvature of the fit correlates them (k, k)."""
    from hjcamp.commands.shared.corner import Estimate
    from hjcamp.diagnosis.estimation.intervals import covariance_of, intervals
    from hjcamp.report.pictures.corner import correlation_of

    analysis = words.analysis
    fitted, blocks = words.verdict.model.fitted, analysis.search.blocks
    spread = np.sqrt(np.maximum(np.diag(covariance_of(fitted, blocks).whole), 0.0))
    found, kept = [], []
    for place, (one, free) in enumerate(zip(intervals(fitted, blocks), fitted.free, strict=True)):
        unit = _unit(words, one.effect, one.name)
        if unit is None or not one.told:
            continue
        kept.append(place)
        label = f"{one.effect} {one.name}".strip().replace("_", " ").replace("delay.", "delay of ")
        error = float(spread[place]) * (one.value if free.log else free.scale)
        found.append(Estimate(one.effect, label, one.value, unit, (one.low, one.high), error, one.at_bound))
    covariance = np.asarray(np.linalg.pinv(fitted.of_readings.information)[np.ix_(kept, kept)])
    return found, correlation_of(covariance)


def _unit(words: Words, effect: str, name: str) -> str | None:
    """Return the SI unit of a fitted parameter, None for the zeros of sensors and for laws without a name."""
    from hjcamp.diagnosis.residuals.simulated import ZERO
    from hjcamp.model.declare.base_values import DELAY

    if effect:
        known = words.analysis.search.library.get(effect)
        return known.parameters[name].unit if known is not None else None
    if name.startswith(ZERO):
        return None
    return "s" if name.startswith(DELAY) else words.analysis.measured.plant.parameters[name].unit
