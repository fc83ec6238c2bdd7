"""Whether a rig has changed since its campaign: the same test again, against how far its repetitions differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
#: How often a rig that has not changed is said to have.
LEVEL = 1e-3
NOT_MEASURED = ("time_s", "phase")


def drift_of(repetitions: Sequence[TestLog], before: Sequence[TestLog], again: TestLog) -> list[dict[str, Any]]:
    r"""Return a row for each field in which a test made again differs from those ``before`` by more than repetitions do.

    .. math:: F = \frac{\langle (x - \bar x)^2 \rangle}{(1 + 1/n)\, s^2}, \quad \nu = \frac{N}{\sum_k \rho_k^2}

    ``repetitions`` give the variance s^2, n tests ``before`` the mean. F has nu and (R - 1) nu degrees of freedom, where rho is the
    autocorrelation of what repetitions do not share (Bartlett 1946); it is compared at LEVEL over the number of fields. With
    fewer than two repetitions nothing can be said, and nothing is.
    """
    from scipy.stats import f as distribution

    if len(repetitions) < 2 or not before:
        return []
    found = []
    fields = [name for name in again.columns if name not in NOT_MEASURED and not name.startswith("reference_")]
    for name in fields:
        logs = (*repetitions, *before, again)
        if any(name not in one.columns for one in logs):
            continue
        length = min(len(one.columns[name]) for one in logs)
        own, old, new = (np.array([one.columns[name][:length] for one in some]) for some in (repetitions, before, [again]))
        apart = own - own.mean(axis=0)
        variance = float(np.sum(apart**2)) / ((len(own) - 1) * length)
        difference = float(np.mean((new[0] - old.mean(axis=0)) ** 2))
        if not (np.isfinite(variance) and np.isfinite(difference) and variance > 0.0):
            continue
        free = max(length / _correlated(apart), 1.0)
        ratio = difference / (variance * (1.0 + 1.0 / len(old)))
        if ratio > distribution.isf(LEVEL / len(fields), free, (len(own) - 1) * free):
            found.append({"field": name, "differs": float(np.sqrt(difference)), "repetitions_differ": float(np.sqrt(variance))})
    return found


def _correlated(apart: Array) -> float:
    """Return the sum over all lags of the squared autocorrelation of rows (R, n).

    Lags beyond half the length, of which there are few products, count as those before them.
    """
    length = apart.shape[1]
    power = np.mean(np.abs(np.fft.rfft(apart, 2 * length, axis=1)) ** 2, axis=0)
    lags = np.arange(max(length // 2, 1))
    correlation = np.fft.irfft(power)[lags] / (length - lags)
    return float(2.0 * (2.0 * np.sum((correlation / correlation[0]) ** 2) - 1.0))
