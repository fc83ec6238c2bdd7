"""Do two means differ? Welch's t test, and Holm's correction where many are asked at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: From below which corrected p on a difference is told as one.
SIGNIFICANT = 0.05
FEWEST = 2  # tests that have a deviation
WITHIN = 0.975  # from below which share of t on a 95 % interval ends
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
    return contrast([one], [other])[2]


def contrast(ours: Sequence[Sample], theirs: Sequence[Sample]) -> tuple[float, float | None, float | None]:
    r"""Return the mean difference of k pairs of samples, half its 95 % interval, and its two-sided p.

    .. math:: d = \frac{1}{k}\sum_i (m_i - m'_i), \quad v_j = \frac{s_j^2}{k^2 n_j}, \quad
        \nu = \frac{(\sum_j v_j)^2}{\sum_j v_j^2/(n_j-1)}, \quad d \pm t_{0.975,\nu} \sqrt{\textstyle\sum_j v_j}

    With one pair this is Welch's test. Interval and p are None where a sample has no deviation (p is 1 where d is 0).
    Source: F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110.
    """
    from scipy.special import stdtr, stdtrit

    pairs, samples = list(zip(ours, theirs, strict=True)), [*ours, *theirs]
    difference = sum(one.mean - other.mean for one, other in pairs) / len(pairs)
    same = abs(difference) <= ROUNDING * max(abs(one.mean) for one in samples)
    if any(one.std is None or one.n < FEWEST for one in samples):
        return difference, None, 1.0 if same else None
    parts = [((one.std or 0.0) / len(pairs)) ** 2 / one.n for one in samples]
    variance = sum(parts)
    # The same test again and again has the deviation of its rounding.
    if same or variance <= (ROUNDING * difference) ** 2:
        return difference, variance**0.5, 1.0 if same else 0.0
    freedom = variance**2 / sum(part**2 / (one.n - 1) for part, one in zip(parts, samples, strict=True))
    p = float(min(1.0, 2.0 * stdtr(freedom, -abs(difference) / variance**0.5)))
    return difference, float(stdtrit(freedom, WITHIN)) * variance**0.5, p


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
