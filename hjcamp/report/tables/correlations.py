"""Correlations of residuals with themselves and with inputs, with what chance stays within."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LAGS = 60
NORMAL = 1.96


@dataclass(frozen=True)
class Correlation:
    """Correlations ``values`` (k,) at ``lags`` (k,), s, and the half width ``band`` (k,) of what chance makes, 95 %."""

    name: str
    lags: Array
    values: Array
    band: Array


def correlations(
    residual: Array, inputs: Mapping[str, Array], parts: Sequence[slice], period: float, most: int = LAGS
) -> list[Correlation]:
    r"""Return the autocorrelation of a residual (n,) and its correlation with each input (n,) that many samples before.

    Only within each of the ``parts``, about their means. White residuals stay within :math:`1.96 / \sqrt n`, those
    correlated with an input by chance alone within :math:`1.96 \sqrt{\sum_i \rho_e(i)\,\rho_u(i) / n}` (Bartlett 1955; Box,
    Jenkins & Reinsel 2008, Time Series Analysis, section 12.1.2).
    """
    most = max(1, min(most, *(max((one.stop - one.start) // 2, 1) for one in parts)))
    lags = np.asarray(period * np.arange(most + 1, dtype=np.float64))
    own = _correlation(residual, residual, parts, most)
    number = sum(one.stop - one.start for one in parts)
    white = np.full(len(lags), NORMAL / np.sqrt(number))
    found = [Correlation("residual with itself", lags, own, white)]
    for name, values in inputs.items():
        if not np.any([np.ptp(values[one]) > 0.0 for one in parts]):
            continue
        similar = _correlation(values, values, parts, most)
        spread = np.sqrt(max(1.0 + 2.0 * float(np.sum(own[1:] * similar[1:])), 1.0) / number)
        crossed = _correlation(residual, values, parts, most)
        found.append(Correlation(f"with {name} before", lags, crossed, np.full(len(lags), NORMAL * spread)))
    return found


def unshared(residual: Array, repeated: Sequence[Sequence[slice]]) -> tuple[Array, NDArray[np.int64], list[slice]]:
    r"""Return what repetitions of a condition do not share of a residual (n,), its rows (k,), and the part of each test in them.

    .. math:: d_{r} = \sqrt{m / (m - 1)}\,(e_r - \tfrac1m \textstyle\sum_s e_s)

    of m repetitions, up to the end of the shortest: no model of these tests can take it. Empty where no condition is repeated.
    """
    found: list[Array] = []
    rows: list[NDArray[np.int64]] = []
    parts: list[slice] = []
    for tests in repeated:
        length, m = min(one.stop - one.start for one in tests), len(tests)
        if m < 2 or length < 2:
            continue
        errors = np.stack([residual[one.start : one.start + length] for one in tests])
        for one, apart in zip(tests, np.sqrt(m / (m - 1.0)) * (errors - errors.mean(axis=0)), strict=True):
            begin = parts[-1].stop if parts else 0
            parts.append(slice(begin, begin + length))
            found.append(apart)
            rows.append(np.arange(one.start, one.start + length))
    if not parts:
        return np.empty(0), np.empty(0, dtype=np.int64), []
    return np.concatenate(found), np.concatenate(rows), parts


def of_repetitions(
    residual: Array, inputs: Mapping[str, Array], repeated: Sequence[Sequence[slice]], period: float
) -> list[Correlation]:
    """Return the `correlations` of what repetitions do not share of a residual; nothing where no condition is repeated."""
    apart, rows, parts = unshared(residual, repeated)
    return correlations(apart, {name: values[rows] for name, values in inputs.items()}, parts, period) if parts else []


def _correlation(late: Array, early: Array, parts: Sequence[slice], most: int) -> Array:
    """Return the correlation of ``late`` with ``early`` 0 ... ``most`` samples before."""
    total, square_late, square_early = np.zeros(most + 1), 0.0, 0.0
    for one in parts:
        a, b = late[one] - np.mean(late[one]), early[one] - np.mean(early[one])
        square_late += float(a @ a)
        square_early += float(b @ b)
        total += [float(a[k:] @ b[: len(b) - k]) for k in range(most + 1)]
    size = np.sqrt(square_late * square_early)
    return np.asarray(total / size if size > 0.0 else total)
