r"""Best subsets on linear responses, each block left out.

For residuals r, slopes S of the base's parameters and responses Z of a set of candidates, all white, the base and the set are
refitted on all blocks but b:

.. math:: \theta = -(\tilde Z^T \tilde Z + P)^{-1} \tilde Z^T \tilde r, \quad
          s_b = \tfrac{n_b}{2} \log \frac{|\tilde r_b|^2}{|\tilde r_b + \tilde Z_b \theta|^2},

where a tilde means: less what S explains of it on the other blocks, and P is what is known of theta beforehand (Stone 1974,
doi:10.1111/j.2517-6161.1974.tb00994.x; best subsets: Hocking & Leslie 1967). No simulation is needed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Of correlations of 1: what two columns that are one share is not divided by nothing.
ROUNDING = 1e-8


@dataclass(frozen=True)
class Column:
    """A candidate at one setting: its responses (n, k), white; what is known of its amplitudes; signs that bounds forbid."""

    name: str
    place: int
    responses: Array
    known: float = 0.0
    one_sided: bool = False


@dataclass(frozen=True)
class Ranked:
    """A set of columns by their positions, with its score on each block left out (blocks,)."""

    columns: tuple[int, ...]
    scores: Array


class Blocks:
    """Second moments of residuals (n,), slopes (n, p) and columns by block (n,), with what the base explains taken out."""

    def __init__(
        self, residuals: Array, slopes: Array, prior: Array, columns: Sequence[Column], blocks: NDArray[np.int64]
    ) -> None:
        self.columns = columns
        ends = np.cumsum([0, *(one.responses.shape[1] for one in columns)])
        self._own = [np.arange(low + 1, high + 1) for low, high in itertools.pairwise(ends)]
        self._known = np.concatenate([[0.0], *(np.full(one.responses.shape[1], one.known) for one in columns)])
        p, names = slopes.shape[1], np.unique(blocks)
        whole = np.column_stack([slopes, residuals, *(one.responses for one in columns)])
        moments = np.stack([whole[blocks == one].T @ whole[blocks == one] for one in names])
        self.counts = np.array([np.sum(blocks == one) for one in names])
        total = moments.sum(axis=0)
        # what the base leaves of a column by no more than rounding is nothing of its own
        self._least = np.maximum(ROUNDING * np.diag(total)[p:], 1e-300)
        # on the other blocks, and on the block itself, after the base has been refitted on the others
        self.others, self.own = [], []
        for one in moments:
            rest = total - one
            change = -np.linalg.lstsq(rest[:p, :p] + prior, rest[:p, p:], rcond=1e-12)[0]
            self.others.append(_moved(rest, change) + change.T @ prior @ change)
            self.own.append(_moved(one, change))

    def ranked(self, sets: Sequence[tuple[int, ...]]) -> list[Ranked]:
        """Return sets of columns with their scores, in their order; none whose signs bounds forbid by what most blocks ask for."""
        rows = [np.concatenate([self._own[k] for k in one]) for one in sets]
        found: dict[int, Ranked] = {}
        for size in {len(one) for one in rows}:
            places = [k for k, one in enumerate(rows) if len(one) == size]
            scores, negative = self._scores(np.array([rows[k] for k in places]))
            for k, score, below in zip(places, scores, negative, strict=True):
                sided = np.concatenate([np.full(len(self._own[c]), self.columns[c].one_sided) for c in sets[k]])
                if not np.any(sided & below):
                    found[k] = Ranked(sets[k], score)
        return [found[k] for k in sorted(found)]

    def _scores(self, rows: NDArray[np.int64]) -> tuple[Array, NDArray[np.bool_]]:
        """Return the scores (sets, blocks) of sets of equal size (sets, k), and which amplitudes most blocks ask below 0."""
        scores, negative = np.empty((len(rows), len(self.own))), np.zeros(rows.shape)
        for b, (others, own) in enumerate(zip(self.others, self.own, strict=True)):
            inner = others[rows[:, :, None], rows[:, None, :]] + self._known[rows][:, :, None] * np.eye(rows.shape[1])
            scale = np.sqrt(np.maximum(np.einsum("skk->sk", inner), self._least[rows]))
            correlation = inner / (scale[:, :, None] * scale[:, None, :]) + ROUNDING * np.eye(rows.shape[1])
            theta = -np.linalg.solve(correlation, (others[rows, 0] / scale)[:, :, None])[:, :, 0] / scale
            negative += theta < 0.0
            after = own[0, 0] + 2.0 * np.sum(theta * own[rows, 0], axis=1)
            after += np.einsum("sk,skl,sl->s", theta, own[rows[:, :, None], rows[:, None, :]], theta)
            scores[:, b] = 0.5 * self.counts[b] * np.log(max(own[0, 0], 1e-300) / np.maximum(after, 1e-300))
        return scores, negative > 0.5 * len(self.own)


def _moved(moments: Array, change: Array) -> Array:
    """Return second moments (p + k, p + k) of columns (k,) of which p others take away as much as ``change`` (p, k) says."""
    p = len(change)
    mixed = moments[p:, :p] @ change
    return np.asarray(moments[p:, p:] + mixed + mixed.T + change.T @ moments[:p, :p] @ change)


def best_settings(singles: Sequence[Ranked], columns: Sequence[Column], most: int) -> list[Ranked]:
    """Return the settings of each candidate that score most in all blocks together, ``most`` of each, best first."""
    found: dict[str, list[Ranked]] = {}
    for one in sorted(singles, key=lambda each: -each.scores.sum()):
        own = found.setdefault(columns[one.columns[0]].name, [])
        if len(own) < most:
            own.append(one)
    return [one for own in found.values() for one in own]


def pairs_of(
    singles: Sequence[Ranked], columns: Sequence[Column], together: Callable[[str, str], bool]
) -> list[tuple[int, ...]]:
    """Return all pairs of columns of two candidates that may stand together."""
    places = [one.columns[0] for one in singles]
    return [
        (a, b)
        for a, b in itertools.combinations(places, 2)
        if columns[a].name != columns[b].name and together(columns[a].name, columns[b].name)
    ]


def kept_by_blocks(
    groups: Sequence[tuple[Sequence[Ranked], int]], blocks: int, law: Callable[[Ranked], Hashable] = lambda one: one.columns
) -> dict[tuple[int, ...], set[int]]:
    """Return the sets that score most in all blocks but one, with the blocks that chose them.

    Each block keeps of each group sets of so many laws: forms of one law do not crowd out another.
    """
    found: dict[tuple[int, ...], set[int]] = {}
    for group, few in groups:
        for b in range(blocks):
            laws: set[Hashable] = set()
            for one in sorted(group, key=lambda one: -(one.scores.sum() - one.scores[b])):
                laws.add(law(one))
                if len(laws) > few:
                    break
                found.setdefault(one.columns, set()).add(b)
    return found
