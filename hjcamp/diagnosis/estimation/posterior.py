r"""Draws of the free parameters from their posterior: the likelihood of the windows, uniform between the bounds.

.. math:: p(x) \propto \exp\bigl(-\ell(\hat x + H^{-1/2} V^{-1/2} (x - \hat x))\bigr)

The map gives the density the curvature of the covariance V with blocks as clusters, in place of the information H of windows that
repeat each other (Chandler & Bate 2007, doi:10.1093/biomet/asm015). Sampled by Metropolis's rule with independent proposals of
Student's t (5 degrees of freedom) about the fit (Tierney 1994, doi:10.1214/aos/1176325750).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, moved_by, whole_loss
from hjcamp.diagnosis.estimation.intervals import covariance_of
from hjcamp.diagnosis.residuals.windows import Windows

Array = NDArray[np.float64]
CHAINS, DRAWS, BEFORE = 4, 500, 50
FREEDOM = 5.0
#: Chains that agree: the ratio of the variance of all to that within (Gelman et al. 2013, section 11.4).
MIXED = 1.01


@dataclass(frozen=True)
class Posterior:
    """Draws (chains, draws, parameters), SI, of parameters called ``names``; ``density`` (chains, draws), its logarithm."""

    names: tuple[str, ...]
    values: Array
    density: Array
    accepted: float

    @property
    def r_hat(self) -> Array:
        """The potential scale reduction of each parameter (parameters,), its chains split in halves."""
        half = self.values.shape[1] // 2
        split = np.concatenate([self.values[:, :half], self.values[:, half : 2 * half]])
        within = split.var(axis=1, ddof=1).mean(axis=0)
        between = split.mean(axis=1).var(axis=0, ddof=1)
        ratio = ((half - 1.0) / half * within + between) / np.where(within > 0.0, within, 1.0)
        return np.asarray(np.sqrt(np.where(within > 0.0, ratio, 1.0)))


def posterior(
    windows: Windows,
    fitted: Fitted,
    blocks: NDArray[np.int64],
    report: Callable[[str, float], None] = lambda text, share: None,
    seed: int = 1,
    draws: int = DRAWS,
) -> Posterior:
    """Return draws of all free parameters of a fit; starts of windows stay where it has put them."""
    if fitted.place is not None:
        windows.place = fitted.place
    fitted = fitted.of_readings
    covariance = covariance_of(fitted, blocks)
    values, vectors = np.linalg.eigh(_symmetric(covariance.whole))
    values = np.maximum(values, 1e-12 * float(values[-1]))
    root = (vectors * np.sqrt(values)) @ vectors.T
    back = (vectors / np.sqrt(values)) @ vectors.T
    known = np.diag(1.0 / covariance.allowed)
    curved, ways = np.linalg.eigh(_symmetric(fitted.information + known))
    curved = np.maximum(curved, 1e-12 * float(curved[-1]))
    mapped = (ways / np.sqrt(curved)) @ ways.T @ back
    centre = np.array([one.of(fitted.candidate) for one in fitted.free])
    ends = [[one.of(one.put(fitted.candidate, end)) for one in fitted.free] for end in (-math.inf, math.inf)]

    def log_density(step: Array) -> float:
        if np.any(centre + step < ends[0]) or np.any(centre + step > ends[1]):
            return -math.inf
        candidate = moved_by(fitted.candidate, fitted.free, mapped @ step)
        found = whole_loss(windows.along(candidate), candidate, fitted.free)
        return fitted.loss - found if math.isfinite(found) else -math.inf

    size, taken = len(centre), 0
    found, densities = np.empty((CHAINS, draws, size)), np.empty((CHAINS, draws))
    for chain in range(CHAINS):
        generator = np.random.default_rng([seed, chain])
        step, here, weight = np.zeros(size), 0.0, 0.0
        for draw in range(-BEFORE, draws):
            white = generator.standard_normal(size) / math.sqrt(generator.chisquare(FREEDOM) / FREEDOM)
            tried = root @ white
            there = log_density(tried)
            proposed = -0.5 * (FREEDOM + size) * math.log1p(float(white @ white) / FREEDOM)
            if math.log(generator.uniform()) < (there - proposed) - (here - weight):
                step, here, weight = tried, there, proposed
                taken += draw >= 0
            if draw >= 0:
                found[chain, draw] = [
                    math.exp(x) if one.log else x * one.scale for one, x in zip(fitted.free, centre + step, strict=True)
                ]
                densities[chain, draw] = here
        report("drawing from the posterior", (chain + 1.0) / CHAINS)
    names = tuple(f"{one.effect}.{one.name}".lstrip(".") for one in fitted.free)
    return Posterior(names, found, densities, taken / (CHAINS * draws))


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.T)
