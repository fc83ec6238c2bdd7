"""Intervals of fitted parameters: chapters are the clusters of the sandwich estimator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.fitting import Fitted
from hjcamp.prediction.levels import LEVEL
from hjcamp.prediction.likelihood import whitener

# Loading on a direction that no reading depends on, beyond rounding.
APART = 1e-6


@dataclass(frozen=True)
class Interval:
    """A fitted parameter, SI: ``effect`` is empty for one of the base; ``at_bound`` where it lies on one of its bounds.

    Where no reading depends on it, alone or together with others, it is not ``told``: it may be all that its bounds allow.
    """

    effect: str
    name: str
    value: float
    low: float
    high: float
    at_bound: bool
    told: bool = True

    @property
    def row(self) -> dict[str, Any]:
        """Its 95 % interval as an answer has it, an end without a bound as null; ``told`` is there where it is false."""
        if self.told:
            return {"ci95": [self.low, self.high]}
        return {"ci95": [end if math.isfinite(end) else None for end in (self.low, self.high)], "told": False}


def covariance_of(fitted: Fitted, chapters: NDArray[np.int64]) -> NDArray[np.float64]:
    r"""Return the covariance (free, free) of the free parameters, in units of their scales.

    .. math:: V = \frac{C}{C - 1} H^{-1} \Bigl(\sum_c g_c g_c^T\Bigr) H^{-1}

    over chapters c (Liang & Zeger 1986, doi:10.1093/biomet/73.1.13).
    """
    w = whitener(fitted.features)
    white, left = np.einsum("wfp,fg->wgp", fitted.slopes, w), fitted.features @ w
    pull = np.einsum("wgp,wg->wp", white, left)
    names = np.unique(chapters)
    clusters = np.array([pull[chapters == one].sum(axis=0) for one in names])
    clusters = clusters - clusters.mean(axis=0)
    bread = np.linalg.pinv(fitted.information)
    count = max(len(names), 2)
    return np.asarray(bread @ (clusters.T @ clusters) @ bread * count / (count - 1))


def not_told(information: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which of the free parameters (free,) may move, alone or together, without a change in any reading."""
    values, vectors = np.linalg.eigh(information)
    still = values <= len(values) * np.finfo(float).eps * max(float(values[-1]), 0.0)
    return np.asarray(np.sqrt((vectors[:, still] ** 2).sum(axis=1)) > APART)


def intervals(fitted: Fitted, chapters: NDArray[np.int64]) -> list[Interval]:
    """Return the value and confidence interval of every free parameter, by Student's t of C - 1 degrees of freedom."""
    from scipy.special import stdtrit

    count = max(len(np.unique(chapters)), 2)
    spread = np.sqrt(np.maximum(np.diag(covariance_of(fitted, chapters)), 0.0))
    reach = float(stdtrit(count - 1, 1.0 - LEVEL / 2.0)) * spread
    found = []
    for one, half, untold in zip(fitted.free, reach, not_told(fitted.information), strict=True):
        x = one.of(fitted.candidate)
        ends = (
            (math.exp(min(x - half, 700.0)), math.exp(min(x + half, 700.0)))
            if one.log
            else tuple(sorted(((x - half) * one.scale, (x + half) * one.scale)))
        )
        value = math.exp(x) if one.log else x * one.scale
        near = 1e-6 * one.scale
        if untold:
            ends = one.low, one.high
        at_bound = bool(value <= one.low + near or value >= one.high - near)
        found.append(
            Interval(
                one.effect,
                one.name,
                float(value),
                float(max(ends[0], one.low)),
                float(min(ends[1], one.high)),
                at_bound,
                not untold,
            )
        )
    return found
