"""Base parameters that a plant's tests cannot tell apart, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hjcamp.prediction.analysis import Analysis


def untold(analysis: Analysis) -> list[str]:
    """Return a sentence for each base parameter that moves together with others in the fit to these tests."""
    from hjcamp.report.pictures.corner import ALIKE, correlation_of

    fitted = analysis.base.fitted
    covariance = np.asarray(np.linalg.pinv(fitted.information), dtype=np.float64)
    alike = np.abs(correlation_of(covariance)) > ALIKE
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
