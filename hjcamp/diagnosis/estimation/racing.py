"""Which of many starts of a fit to go on with: all are fitted to some of the windows, and the better half goes on in each turn."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free, fit
from hjcamp.diagnosis.levels import FITTED_STARTS
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.model.declare.candidate import Candidate

# Starts are judged by one in so many runs of windows.
RACED = 4


def raced(windows: Windows, starts: Iterable[Candidate], free_of: Callable[[Candidate], Sequence[Free]]) -> list[Fitted]:
    """Return the fits to ``windows`` that are ahead after their starts were halved in turn, the best first; none that diverges.

    Each turn is a fit with the windows' starts as they are, which are moved along after it (successive halving: Jamieson & Talwalkar
    2016, arXiv:1502.07943).
    """

    def turned(start: Candidate, near: Fitted | None = None) -> Fitted:
        own = copy.copy(windows)
        if near is not None and near.place is not None:
            own.place = near.place
        features = own.move_starts(start, rounds=1)
        return replace(fit(own, start, free_of(start), near=near, exact=False, features=features), place=own.place)

    racing = [turned(one) for one in starts if np.isfinite(windows.predicted(one).readings).all()]
    while len(racing) > FITTED_STARTS:
        racing = sorted(racing, key=lambda one: one.loss)[: -(-len(racing) // 2)]
        racing = [turned(one.candidate, one) for one in racing]
    return sorted(racing, key=lambda one: one.loss)
