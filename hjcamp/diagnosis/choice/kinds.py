"""An analysis with all residual kinds: balances with the predictions over windows, and the base fitted to both."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.repeatability import Repeatability, repeatability_of
from hjcamp.diagnosis.estimation.gauss_newton import fit
from hjcamp.diagnosis.residuals.balances import Balances
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Alone:
    """Balances in the place of windows, for fits that simulate nothing."""

    balances: Balances

    def along(self, candidate: Candidate) -> Array:
        """Return the balances (windows, features) of a candidate."""
        return self.balances.features(candidate)


@dataclass(frozen=True)
class Judged:
    """What is judged by: a search over windows with balances, its base, what cannot be explained, and the channels of the features.

    ``channels`` are the features of each sensor, then of each balance.
    """

    search: Search
    base: Scored
    repeatability: Repeatability
    channels: tuple[slice, ...]


def judged(analysis: Analysis) -> Judged:
    """Return an analysis with every residual kind that its measured states allow."""
    search, base, windows = analysis.search, analysis.base, analysis.windows
    layout = windows.layout
    widths = [layout.basis.shape[1]] * len(layout.measured.sensors)
    windows.place = base.place
    candidate = base.fitted.candidate
    plain = candidate.without(windows.forms)
    balances = Balances.of(layout, windows.kernels, plain, windows.predicted(candidate), search.blocks)
    channels = _slices(widths + [one.features for one in (balances.balanced if balances else ())])
    if balances is None:
        return Judged(search, base, repeatability_of(layout, base.fitted.features, channels), channels)
    own = copy.copy(search)
    own.windows, own.steps = replace(windows, balances=balances), []
    own.windows.place = base.place
    found = _base(own, base, balances)
    own.windows.place = found.place
    return Judged(own, found, repeatability_of(layout, found.fitted.features, channels), channels)


def _slices(widths: Sequence[int]) -> tuple[slice, ...]:
    """Return where channels of these widths stand, one behind the other."""
    ends = list(itertools.accumulate(widths, initial=0))
    return tuple(slice(low, high) for low, high in itertools.pairwise(ends))


def _base(search: Search, base: Scored, balances: Balances) -> Scored:
    """Return the base fitted to all kinds: from where it stands, or from where the balances alone have it, what fits better."""
    candidate, windows = base.fitted.candidate, search.windows
    starts = [candidate]
    free = [one for one in search.free_of(candidate) if not one.effect]
    alone: Windows = Alone(balances)  # type: ignore[assignment]
    begun = fit(alone, candidate.with_base({one.name: search.declared[one.name] for one in free}), free)
    if np.isfinite(begun.loss):
        starts.append(begun.candidate)
    fits = []
    for one in starts:
        windows.place = base.place
        fits.append(search.fitted(one))
    return min(fits, key=lambda one: one.fitted.loss)
