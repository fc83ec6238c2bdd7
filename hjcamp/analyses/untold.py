"""Base parameters that a plant's tests cannot tell apart, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hjcamp.prediction.selection.analysis import Analysis


def untold(analysis: Analysis) -> list[str]:
    """Return a sentence for each base parameter that moves together with others in the fit to these tests.

    None where its interval is narrow all the same: within a share of its value that matters.
    """
    from hjcamp.prediction.fitting.intervals import intervals
    from hjcamp.prediction.levels import MATTERS
    from hjcamp.report.pictures.corner import ALIKE, correlation_of

    fitted = analysis.base.fitted
    covariance = np.asarray(np.linalg.pinv(fitted.information), dtype=np.float64)
    alike = np.abs(correlation_of(covariance)) > ALIKE
    base = analysis.measured.plant.base_parameters
    found = intervals(fitted, analysis.search.chapters)
    wide = [not one.told or one.high - one.low > 2.0 * MATTERS * abs(one.value) for one in found]
    names = [one.name if not one.effect and one.name in base and far else "" for one, far in zip(found, wide, strict=True)]
    said = []
    for place, name in enumerate(names):
        partners = [other for one, other in enumerate(names) if other and one != place and alike[place, one]]
        if name and partners:
            said.append(
                f"{name} cannot be told from {', '.join(partners)} by these tests: give one of them (base=False)"
            )
    return said
