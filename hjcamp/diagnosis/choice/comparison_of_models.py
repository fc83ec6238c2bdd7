"""Comparisons of models by blocks left out: nested choice as a gate, and the model confidence set."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MOST_FLIPS = 2000


def nested_choice(scores: Array, allowed: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return which model predicts each block (blocks,): the best on all other blocks of those chosen without it; -1 is the base.

    ``scores`` (models, blocks) are log scores against the base, ``allowed`` (models, blocks) says which models were chosen without a
    block (Varma & Simon 2006, doi:10.1186/1471-2105-7-91).
    """
    rest = scores.sum(axis=1, keepdims=True) - scores
    rest = np.where(allowed, rest, -np.inf)
    if not len(rest):
        return np.full(scores.shape[1], -1)
    best = np.argmax(rest, axis=0)
    return np.where(np.take_along_axis(rest, best[None], axis=0)[0] > 0.0, best, -1)


def flips_of(blocks: int, seed: int = 1) -> Array:
    """Return sign vectors (flips, blocks): all where they are few, else drawn at random; the first changes no sign."""
    if 2**blocks <= MOST_FLIPS:
        return np.array(list(itertools.product((1.0, -1.0), repeat=blocks)))
    drawn = np.random.default_rng(seed).choice((1.0, -1.0), size=(MOST_FLIPS, blocks))
    drawn[0] = 1.0
    return np.asarray(drawn)


def flipped_t(values: Array, weights: Array, flips: Array) -> Array:
    """Return Student's t (flips,) of the ratio of values to weights (blocks,), as `ratio_t` has it, under changes of sign."""
    whole = float(weights.sum())
    if whole <= 0.0:
        return np.zeros(len(flips))
    signed = flips * values
    share = signed.sum(axis=1, keepdims=True) / whole
    rest = np.maximum(whole - weights, 1e-12 * whole)
    spread = np.sqrt(np.sum(((signed - share * weights) / rest) ** 2, axis=1))
    return np.asarray(share[:, 0] / np.maximum(spread, 1e-300))


def confidence_set(advantage: Array, apart: Array, alpha: float, seed: int = 1) -> list[int]:
    """Return the models that are not ruled out (Hansen, Lunde & Nason 2011, doi:10.3982/ECTA5771).

    ``advantage`` (models, models, blocks) is by how much the first is better than the second in each block, ``apart`` what each block
    could distinguish the two by. The statistic is the largest t of all pairs, its law that under flips of the blocks' signs, the same
    for all pairs (Romano & Wolf 2005). A pair counts where its scores add up to more than log(1 / alpha).
    """
    left = list(range(len(advantage)))
    flips = flips_of(advantage.shape[2], seed)
    while len(left) > 1:
        pairs = [(i, j) for i in left for j in left if i != j]
        t = np.array([flipped_t(advantage[i, j], apart[i, j], flips) for i, j in pairs])
        real = np.array(
            [
                one[0] if advantage[i, j].sum() > math.log(1.0 / alpha) else -math.inf
                for one, (i, j) in zip(t, pairs, strict=True)
            ]
        )
        worst = int(np.argmax(real))
        if not np.mean(t.max(axis=0) >= real[worst]) <= alpha:
            break
        left.remove(pairs[worst][1])
    return left


def not_worse(errors: Sequence[Array], delta: float) -> list[int]:
    """Return the models whose errors (channels,) are no more than delta above the least of all in every channel.

    Errors are shares of what lies above repeatability: what differs by less than delta does not matter.
    """
    least = np.min(np.array(errors), axis=0)
    return [k for k, one in enumerate(errors) if np.all(one <= least + delta)]
