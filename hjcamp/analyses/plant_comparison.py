"""Models of any plant compared with measured tests, and each of them without one of its effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hjcamp.diagnosis.results.comparison import Comparison, Shown, predicted_errors, shown_of, whole_model
from hjcamp.model.declare.candidate import Candidate


@dataclass(frozen=True)
class PlantComparison(Comparison):
    """Models of any plant on the same tests; ``lesser`` are the models that have effects, each without one of them."""

    lesser: tuple[Shown, ...]


def with_lesser(found: Comparison, models: Mapping[str, Candidate]) -> PlantComparison:
    """Return a comparison of ``models`` with each of them without one of its effects; one that diverges is left out."""
    analysis = found.analysis
    measured = analysis.windows.layout.measured
    there, lesser = {one.key for one in models.values()}, []
    for name, model in models.items():
        for effect in model.effects:
            less = model.without([effect])
            if less.key in there:
                continue
            features, errors = predicted_errors(analysis, whole_model(measured, less))
            if np.isfinite(features).all():
                lesser.append(shown_of(analysis, f"{name} without {effect}", features, errors))
    return PlantComparison(analysis, found.models, found.calibrated, tuple(lesser))
