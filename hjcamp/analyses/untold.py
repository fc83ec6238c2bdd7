"""Base parameters that a plant's tests cannot tell apart, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hjcamp.prediction.analysis import Analysis

#: Correlation beyond which only a product or a sum of two is known.
ALIKE = 0.98


def untold(analysis: Analysis) -> list[str]:
    """Return a sentence for each base parameter that moves together with others in the fit to these tests."""
    from hjcamp.prediction.intervals import covariance_of

    fitted = analysis.base.fitted
    covariance = covariance_of(fitted, analysis.search.chapters)
    spread = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    alike = np.abs(covariance / np.outer(spread, spread)) > ALIKE
    base = analysis.measured.plant.base_parameters
    names = [free.name if not free.effect and free.name in base else "" for free in fitted.free]
    said = []
    for place, name in enumerate(names):
        partners = [other for one, other in enumerate(names) if other and one != place and alike[place, one]]
        if name and partners:
            said.append(
                f"{name} cannot be told from {', '.join(partners)} by these tests: give one of them (base=False)"
            )
    return said
