"""All residual kinds of an analysis: balances with the predictions over windows, and the base fitted to both."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import repeatability_of
from hjcamp.diagnosis.estimation.gauss_newton import fit
from hjcamp.diagnosis.residuals.balances import Balances
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search
from hjcamp.diagnosis.validation.channels import Channels
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Alone:
    """Balances in the place of windows, for fits that simulate nothing."""

    balances: Balances

    def along(self, candidate: Candidate) -> Array:
        """Return the balances (windows, features) of a candidate."""
        return self.balances.features(candidate)


def with_balances(search: Search, base: Scored) -> tuple[Scored, Channels]:
    """Return the base fitted to every residual kind that the measured states allow, and the channels of its features.

    The windows of the ``search`` have the balances from here on.
    """
    windows = search.windows
    layout = windows.layout
    windows.place = base.place
    candidate = base.fitted.candidate
    plain = candidate.without(windows.forms)
    windows.balances = Balances.of(layout, windows.kernels, plain, windows.predicted(candidate), search.blocks)
    balanced = windows.balances.balanced if windows.balances else ()
    found = _base(search, base, windows.balances) if windows.balances else base
    windows.place = found.place
    widths = {one.field: layout.basis.shape[1] for one in layout.measured.sensors}
    for one in balanced:
        widths |= one.channels
    columns = _slices(list(widths.values()))
    # what adds up over a block is one number there, whatever windows it has
    runs = len(np.unique(np.column_stack([layout.of_test, search.blocks]), axis=0))
    lasting = {one.lasting for one in balanced}
    together = [len(search.blocks) / runs if name in lasting else 1.0 for name in widths]
    known = repeatability_of(layout, found.fitted.features, columns, together)
    return found, Channels(tuple(widths), columns, known)


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
