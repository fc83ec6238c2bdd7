"""Intervals of fitted parameters, by the jackknife over blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free
from hjcamp.diagnosis.estimation.likelihood import whitener
from hjcamp.diagnosis.levels import LEVEL

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


def limited(row: Mapping[str, Any]) -> bool:
    """Whether a row of a base parameter stands at a bound that is no natural one: none has less friction than 0."""
    return bool(row.get("at_bound") and abs(row["value"]) > 1e-9 * max(abs(end or 0.0) for end in row["ci95"]))


@dataclass(frozen=True)
class Covariance:
    """The covariance (free, free) of the free parameters, in units of their scales, by what it comes from.

    ``allowed`` (free,) is what the bounds of each allow by themselves, infinite without them; ``still`` (free,) is true where
    neither readings nor bounds hold it.
    """

    readings: NDArray[np.float64]
    bounds: NDArray[np.float64]
    allowed: NDArray[np.float64]
    still: NDArray[np.bool_]

    @property
    def whole(self) -> NDArray[np.float64]:
        """Both together."""
        return self.readings + self.bounds

    @property
    def told(self) -> NDArray[np.bool_]:
        """Whether readings hold each parameter (free,) more than bounds do: these alone leave less than half of what they allow."""
        return ~self.still & (np.diag(self.bounds) <= 0.5 * self.allowed)


def covariance_of(fitted: Fitted, blocks: NDArray[np.int64]) -> Covariance:
    r"""Return the covariance of the free parameters.

    .. math:: V = \frac{C - 1}{C} \sum_c (d_c - \bar d)(d_c - \bar d)^T + B P B, \quad d_c = (H - H_c + P)^{-1} g_c, \quad
              B = (H + P)^{-1}, \quad P = \mathrm{diag}\frac{12}{(x_{high} - x_{low})^2}

    d_c is by how much the fit moves without block c, one Gauss-Newton step: the jackknife over clusters, which does not grow too small
    where blocks are few and tell unequally much (Bell & McCaffrey 2002, Survey Methodology 28(2), 169-181; MacKinnon, Nielsen & Webb
    2023, doi:10.1002/jae.2969). What one block alone tells is not known to be repeated: its share counts as 1 - 1 / C at most. P is
    what bounds tell, as much as a uniform density between them: the zero of a counter is known to one step, whatever the readings say.
    """
    w = whitener(fitted.features)
    white, left = np.einsum("wfp,fg->wgp", fitted.slopes, w), fitted.features @ w
    pull = np.einsum("wgp,wg->wp", white, left)
    names = np.unique(blocks)
    allowed = np.array([_range(one) ** 2 / 12.0 for one in fitted.free])
    known = np.diag(1.0 / allowed)
    values, vectors = np.linalg.eigh(fitted.of_readings.information + known)
    held = values > len(values) * np.finfo(float).eps * max(float(values[-1]), 0.0)
    root = vectors[:, held] / np.sqrt(values[held])
    count = max(len(names), 2)
    moved = np.zeros((len(names), len(allowed)))
    for row, own in zip(moved, (blocks == one for one in names), strict=True):
        own_slopes = white[own].reshape(-1, white.shape[2]) @ root
        shares, ways = np.linalg.eigh(own_slopes.T @ own_slopes)
        row[:] = root @ ((ways / (1.0 - np.minimum(shares, 1.0 - 1.0 / count))) @ ways.T) @ (root.T @ pull[own].sum(axis=0))
    moved -= moved.mean(axis=0)
    bread = root @ root.T
    still = np.sqrt((vectors[:, ~held] ** 2).sum(axis=1)) > APART
    return Covariance(moved.T @ moved * (count - 1) / count, bread @ known @ bread, allowed, still)


def _range(one: Free) -> float:
    """Return how far the bounds of a free parameter are apart, in units of its scale (of their logarithms)."""
    if not math.isfinite(one.high) or not math.isfinite(one.low):
        return math.inf
    return math.log(one.high / one.low) if one.log else (one.high - one.low) / one.scale


def intervals(fitted: Fitted, blocks: NDArray[np.int64]) -> list[Interval]:
    """Return the value and confidence interval of every free parameter, by Student's t of C - 1 degrees of freedom."""
    from scipy.special import stdtrit

    count = max(len(np.unique(blocks)), 2)
    found = covariance_of(fitted, blocks)
    spread = np.sqrt(np.maximum(np.diag(found.whole), 0.0))
    reach = float(stdtrit(count - 1, 1.0 - LEVEL / 2.0)) * spread
    rows = []
    for one, half, told in zip(fitted.free, reach, found.told, strict=True):
        x = one.of(fitted.candidate)
        ends = (
            (math.exp(min(x - half, 700.0)), math.exp(min(x + half, 700.0)))
            if one.log
            else tuple(sorted(((x - half) * one.scale, (x + half) * one.scale)))
        )
        if not told:
            ends = one.low, one.high
        value = math.exp(x) if one.log else x * one.scale
        near = 1e-6 * one.scale
        at_bound = bool(value <= one.low + near or value >= one.high - near)
        rows.append(
            Interval(
                one.effect,
                one.name,
                float(value),
                float(max(ends[0], one.low)),
                float(min(ends[1], one.high)),
                at_bound,
                bool(told),
            )
        )
    return rows
