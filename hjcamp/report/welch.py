"""Do two means differ? Welch's t test, and Holm's correction where many are asked at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: From below which corrected p on a difference is told as one.
SIGNIFICANT = 0.05
FEWEST = 2  # tests that have a deviation
# Differences this small beside the means are rounding of the sums, not physics.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Sample:
    """Mean, sample standard deviation and number of tests of one indicator in one condition."""

    mean: float
    std: float | None
    n: int


def welch(one: Sample, other: Sample) -> float | None:
    r"""Return the two-sided p of Welch's t test; None where a sample has no deviation and the means differ.

    .. math:: t = \frac{m_1 - m_2}{\sqrt{s_1^2/n_1 + s_2^2/n_2}}, \quad
        \nu = \frac{(s_1^2/n_1 + s_2^2/n_2)^2}{(s_1^2/n_1)^2/(n_1-1) + (s_2^2/n_2)^2/(n_2-1)}

    Independent, nearly normal samples; deviations may be unequal. Without any scatter every difference is certain.
    Source: B. L. Welch, Biometrika 34 (1947) 28.
    """
    from scipy.special import stdtr

    difference = one.mean - other.mean
    if abs(difference) <= ROUNDING * max(abs(one.mean), abs(other.mean)):
        return 1.0
    if one.std is None or other.std is None or min(one.n, other.n) < FEWEST:
        return None
    parts = [sample.std**2 / sample.n for sample in (one, other) if sample.std is not None]
    variance = sum(parts)
    # The same test again and again has the deviation of its rounding.
    if variance <= (ROUNDING * difference) ** 2:
        return 0.0
    freedom = variance**2 / sum(part**2 / (n - 1) for part, n in zip(parts, (one.n, other.n), strict=True))
    return float(min(1.0, 2.0 * stdtr(freedom, -abs(difference) / variance**0.5)))


def holm(p_values: Sequence[float | None]) -> list[float | None]:
    r"""Return the p values corrected for their number; None stays None and does not count.

    .. math:: \tilde p_{(i)} = \max_{j \le i} \min(1, (m - j + 1)\, p_{(j)})

    The chance that any of m equal pairs is told to differ is then at most the level, whatever their dependence.
    Source: S. Holm, Scandinavian Journal of Statistics 6 (1979) 65.
    """
    known: NDArray[np.float64] = np.array([one for one in p_values if one is not None], dtype=float)
    order = np.argsort(known, kind="stable")
    factors = np.arange(len(known), 0, -1)
    stepped = np.maximum.accumulate(np.minimum(1.0, factors * known[order]))
    corrected = np.empty(len(known))
    corrected[order] = stepped
    left = iter(corrected.tolist())
    return [None if one is None else next(left) for one in p_values]
