"""Whether the base fits better from where a fit with something added has led it: then it had been calibrated to a poor minimum."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.multistart import elsewhere
from hjcamp.diagnosis.estimation.gauss_newton import settled
from hjcamp.diagnosis.levels import DELTA, LEVEL
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.candidate import Candidate


def better_base(analysis: Analysis, said: Scored, others: Iterable[Scored]) -> dict[str, float] | None:
    """Return base parameters that fit better than those of an analysis, by a likelihood ratio and by a share that matters.

    They are looked for from where the model of an answer has them (what is ``said``), without its effects, and from where ``others`` of
    the same windows have one that is half as far off at least as the base was begun from. None where nothing fits better.
    """
    from scipy.special import chdtri

    base, found = analysis.base.fitted, None
    least = base.loss - 0.5 * float(chdtri(1, LEVEL))
    names, share = analysis.measured.plant.base_parameters, analysis.channels.share
    for one in (said, *others):
        start = Candidate(one.fitted.candidate.base, base.candidate.effects)
        if not one.beyond(analysis.base) or (one is not said and not elsewhere(start, base.candidate, names)):
            continue
        fitted = settled(analysis.windows.begun_for(start, one.place), start, base.free)
        if np.isfinite(fitted.loss) and fitted.loss < least and share(fitted.features, base.features, base.features) >= DELTA:
            least, found = fitted.loss, dict(fitted.candidate.base)
    return found
