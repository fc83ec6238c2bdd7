r"""How well features of a model are explained: Gaussian windows with an unknown covariance.

.. math:: \ell = \tfrac{n}{2} \log \det\Bigl(\tfrac{1}{n} \sum_w f_w f_w^T + I\Bigr)

up to constants, for n windows; the identity is the noise of the sensors, below which nothing counts (Seber 1984, Multivariate
Observations, section 3.2; Bard 1974, section 4.2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def covariance(features: Array) -> Array:
    """Return the second moments of features (windows, d), drawn towards their diagonal where windows are few, plus noise."""
    n, d = features.shape
    found = features.T @ features / n
    share = min(1.0, d / n)
    return np.asarray((1.0 - share) * found + share * np.diag(np.diag(found)) + np.eye(d))


def loss(features: Array) -> float:
    """Return the negative log-likelihood, up to a constant; infinite where a feature is not finite."""
    return 0.5 * len(features) * _volume(features)


def whitener(features: Array) -> Array:
    """Return the matrix (d, d) that makes features of this covariance white: f @ whitener."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance(features))).T)


def size(features: Array) -> float:
    """Return one size of the features: the geometric mean of their standard deviations along independent directions.

    Infinite where a model diverges.
    """
    return float(np.exp(0.5 * _volume(features) / features.shape[1]))


def _volume(features: Array) -> float:
    """Return the logarithm of the determinant of their covariance; infinite where a feature, or its square, is no number."""
    with np.errstate(over="ignore", invalid="ignore"):
        moments = covariance(features)
    return float(np.linalg.slogdet(moments)[1]) if np.isfinite(moments).all() else np.inf
