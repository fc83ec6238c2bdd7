"""Linear machines whose truth is known: features, the models of a small library on blocks left out, nothing simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import repeatability_of
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search
from hjcamp.diagnosis.validation.channels import Channels
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
WINDOWS, SIZE, BLOCKS = 48, 4, 12


def all_features(one: Scored, other: Scored) -> tuple[Array, Array, Array, Array]:
    """Compare two models by all their features: nothing of them remembers, or errs in a sensor."""
    return one.features, other.features, one.fitted.features, other.fitted.features


class Toy:
    """Repetitions of one test under a library; what ``acts`` are responses (windows, d, k) times amplitudes."""

    def __init__(self, seed: int, repetitions: int = 3, scatter: float = 3.0, windows: int = WINDOWS) -> None:
        self.random, self.scatter, self.repetitions = np.random.default_rng(seed), scatter, repetitions
        self.windows = windows
        self.blocks = np.tile(np.arange(windows) * BLOCKS // windows, repetitions)
        self.features = scatter * self.random.standard_normal((repetitions * windows, SIZE))
        self.library: dict[str, Array] = {}
        self.terms: dict[str, Array] = {}

    def response(self, *others: tuple[float, Array]) -> Array:
        """Return a response (windows, d, 1) of unit rms of its own, and so much of others."""
        return np.asarray(self.random.standard_normal((self.windows, SIZE, 1)) + sum(share * one for share, one in others))

    def acts(self, response: Array, size: float) -> None:
        """Let something act, ``size`` times the scatter."""
        self.features = self.features + size * self.scatter * np.tile(response[:, :, 0], (self.repetitions, 1))

    def models(self, sets: Sequence[Sequence[str]] = (), free: Sequence[Any] = ()) -> Any:
        """Return what `Decision` asks of models: each candidate by itself, and the sets of them that are named."""
        every = {**self.library, **self.terms}
        base = self._scored((), self.features, self.features, free)
        fits = [self._fitted(one, every) for one in ([name] for name in every)] + [self._fitted(one, every) for one in sets]
        conditions = {"a": list(range(self.repetitions))} if self.repetitions > 1 else {"a": [0]}
        measured = SimpleNamespace(sensors=("one", "two"), conditions=conditions, noise=np.ones(2))
        of_test = np.repeat(np.arange(self.repetitions), self.windows)
        layout: Any = SimpleNamespace(measured=measured, of_test=of_test)
        columns = (slice(0, SIZE // 2), slice(SIZE // 2, SIZE))
        channels = Channels(("one", "two"), columns, repeatability_of(layout, self.features, columns))
        windows, search = SimpleNamespace(layout=layout), search_of(self.blocks)
        analysis = SimpleNamespace(channels=channels, measured=measured, windows=windows, base=base, held=())
        number = frozenset(range(BLOCKS))
        return SimpleNamespace(
            analysis=analysis,
            base=base,
            blocks=self.blocks,
            names=np.arange(BLOCKS),
            compared=all_features,
            terms=self.terms,
            search=search,
            all=tuple(SimpleNamespace(scored=one, blocks=number) for one in fits),
            named=_of_one(fits, self.library),
            non_parametric=_of_one(fits, self.terms),
        )

    def _fitted(self, names: Sequence[str], every: Mapping[str, Array]) -> Scored:
        """Return the features of a set of candidates by least squares: of all, and of each block by the fit of the others."""
        z = np.tile(np.concatenate([every[name] for name in names], axis=2), (self.repetitions, 1, 1))
        each = [self.blocks == block for block in range(BLOCKS)]
        moments = np.array([np.einsum("wdk,wdl->kl", z[rows], z[rows]) for rows in each])
        pulls = np.array([np.einsum("wdk,wd->k", z[rows], self.features[rows]) for rows in each])
        whole, pull, out = moments.sum(axis=0), pulls.sum(axis=0), self.features.copy()
        fitted = self.features - z @ np.linalg.solve(whole, pull)
        for rows, moment, own in zip(each, moments, pulls, strict=True):
            out[rows] -= z[rows] @ np.linalg.solve(whole - moment, pull - own)
        return self._scored(names, fitted, out)

    def _scored(self, names: Sequence[str], fitted: Array, features: Array, free: Sequence[Any] = ()) -> Scored:
        own: Any = SimpleNamespace(features=fitted, free=tuple(free), candidate=Candidate({one.name: one.low for one in free}))
        place: Any = None
        return Scored(tuple(names), own, features, float(np.sqrt(np.mean(features**2))), place)


def _of_one(fits: Sequence[Scored], among: Mapping[str, Array]) -> list[Scored]:
    own = [one for one in fits if len(one.names) == 1 and one.names[0] in among]
    return sorted(own, key=lambda one: one.left_out)


def search_of(blocks: NDArray[np.int64]) -> Search:
    """Return what compares two models over blocks (windows,)."""
    search = Search.__new__(Search)
    search.blocks, search.seed = blocks, 1
    return search
