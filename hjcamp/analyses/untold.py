"""Base parameters that a plant's tests cannot distinguish, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis


def untold(analysis: Analysis) -> list[str]:
    """Return a sentence for each group of base parameters that move together in the fit to these tests.

    None of one whose interval is narrow all the same: within a share of its value that matters.
    """
    from scipy.sparse.csgraph import connected_components

    from hjcamp.diagnosis.estimation.intervals import intervals
    from hjcamp.diagnosis.levels import DELTA
    from hjcamp.report.pictures.corner import SIMILAR, correlation_of

    fitted = analysis.base.fitted
    covariance = np.asarray(np.linalg.pinv(fitted.of_readings.information), dtype=np.float64)
    similar = np.abs(correlation_of(covariance)) > SIMILAR
    base = analysis.measured.plant.base_parameters
    found = intervals(fitted, analysis.search.blocks)
    wide = [not one.told or one.high - one.low > 2.0 * DELTA * abs(one.value) for one in found]
    kept = [k for k, one in enumerate(found) if not one.effect and one.name in base and wide[k]]
    group = connected_components(similar[np.ix_(kept, kept)], directed=False)[1]
    groups = [[found[k].name for k, own in zip(kept, group, strict=True) if own == each] for each in dict.fromkeys(group)]
    return [
        f"These tests do not distinguish {', '.join(names[:-1])} and {names[-1]}: give one of them (base=False)."
        for names in groups
        if len(names) > 1
    ]
