"""Parameter sets that measured tests allow of a fitted model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.estimation.intervals import covariance_of
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
HALVINGS = 6
# A parameter that the tests hardly tell is moved by no more than its usual size, or by this factor.
FARTHEST = 1.0


def draws(analysis: Analysis, model: Scored, number: int, seed: int) -> list[Candidate]:
    r"""Return ``number`` models with the parameters of a fit moved within what the tests say of them.

    .. math:: \theta \sim N(\hat\theta, V), \quad \ell(\theta) - \ell(\hat\theta) \le \max(1, \delta^T H \delta)

    V is the covariance over blocks, H the information of the fit. A draw whose loss grows by more than twice what a parabola
    says is drawn half as far: there the fit is not a parabola. Each draw is followed by its mirror image (antithetic pairs).
    """
    fitted, windows = model.fitted, analysis.windows
    if not fitted.free:
        return [fitted.candidate] * number
    generator = np.random.default_rng((seed, len(fitted.free), number))
    spread, ways = np.linalg.eigh(covariance_of(fitted, analysis.search.blocks).whole)
    place, windows.place = windows.place, model.place
    found: list[Candidate] = []
    while len(found) < number:
        step = ways @ (np.sqrt(np.maximum(spread, 0.0)) * generator.standard_normal(len(spread)))
        for sign in (1.0, -1.0)[: number - len(found)]:
            found.append(_moved(analysis, model, np.clip(sign * step, -FARTHEST, FARTHEST)))
    windows.place = place
    return found


def _moved(analysis: Analysis, model: Scored, step: Array) -> Candidate:
    fitted = model.fitted
    for _ in range(HALVINGS):
        candidate = fitted.candidate
        for one, x in zip(fitted.free, step, strict=True):
            candidate = one.into(candidate, one.of(candidate) + float(x))
        more = loss(analysis.windows.features(candidate)) - fitted.loss
        if more <= max(1.0, float(step @ fitted.information @ step)):
            return candidate
        step = 0.5 * step
    return fitted.candidate
