"""Responses of candidates relative to a fitted model, scored on blocks left out without a further simulation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.choice.subsets import Blocks, Column
from hjcamp.diagnosis.screening.screening import Projection
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search

Array = NDArray[np.float64]


class Responses:
    """The responses of candidates (``names``) relative to a fitted model, at each setting of their shapes."""

    def __init__(self, search: Search, model: Scored, names: Sequence[str]) -> None:
        self.model, self.search = model, search.at(model.place)
        own, fitted = self.search, model.fitted
        own.windows.kernels.hold(fitted.candidate.effects)
        own.windows.kernels.prepare(names)
        own.probed_model(fitted)
        found = own.each(lambda name: own.probes(fitted, name), names, lambda name: f"responses of {name.replace('_', ' ')}")
        self.probes = [probe for one in found for probe in one]
        self.projection = Projection(fitted)

    @cached_property
    def columns(self) -> list[Column]:
        """The responses as white columns, with what is known of their amplitudes."""
        found = []
        for k, probe in enumerate(self.probes):
            free = self.search.unknowns.get(probe.effect)
            known = float(probe.sizes[0] / free.usual) ** 2 if free else 0.0
            responses = np.einsum("wfk,fg->wgk", probe.responses, self.projection.whitener)
            column = responses.reshape(-1, probe.responses.shape[2])
            found.append(Column(probe.effect, k, column, known, probe.one_sided))
        return found

    @cached_property
    def moments(self) -> Blocks:
        """The second moments of the model's residuals, the slopes of its free parameters and the columns, by block."""
        fitted, white = self.model.fitted, self.projection.whitener
        free = [k for k, one in enumerate(fitted.free) if not one.bounded(fitted.candidate)]
        slopes = np.einsum("wfp,fg->wgp", fitted.slopes[:, :, free], white).reshape(fitted.features.size, len(free))
        residuals, d = (fitted.features @ white).ravel(), fitted.features.shape[1]
        prior = np.diag([fitted.free[k].slope ** 2 for k in free]) if free else np.zeros((0, 0))
        rows = np.unique(np.repeat(self.search.blocks, d), return_inverse=True)[1]
        return Blocks(residuals, slopes, prior, self.columns, rows)

    def fitted(self, name: str) -> Scored | None:
        """Return the model with one candidate, from starts of its own; None where nothing finite is found."""
        search = self.search
        effect = search.unknowns[name].effect if name in search.unknowns else search.library[name]
        promises = [self.projection.promise(one, effect) for one in self.probes if one.effect == name]
        if not promises:
            return None
        if name in search.unknowns:
            begun = search.begun_unknown(self.model.fitted, promises[0])
        else:
            begun = search.begun(self.projection, name, promises)
        return search.fitted(begun.candidate, begun) if np.isfinite(begun.loss) else None
