"""Lines in a spectrum: what swings at one frequency by itself, whatever else there is at other frequencies."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Of the tapers: their half bandwidth in ends of the test, and how many of them are free of what lies outside.
BANDWIDTH, TAPERS = 4.0, 7
# Frequencies that are looked at for each that a test tells apart.
FINER = 4


@lru_cache(maxsize=16)
def _tapers(samples: int) -> Array:
    """Return the discrete prolate spheroidal sequences (tapers, samples)."""
    from scipy.signal.windows import dpss

    return np.asarray(dpss(samples, BANDWIDTH, TAPERS))


def chances(values: Array) -> tuple[Array, Array]:
    r"""Return the frequencies (f,), cycles per sample, at which values (n,) may have a line, and the chance of each (f,).

    .. math:: F = \frac{(K - 1)\,|\mu|^2 \sum_k U_k(0)^2}{\sum_k |y_k - \mu U_k(0)|^2},
        \quad \mu = \frac{\sum_k U_k(0)\,y_k}{\sum_k U_k(0)^2}

    ``y_k`` is the spectrum under the k-th of K = 7 tapers, ``U_k(0)`` the taper's sum. F with 2 and 2 K - 2 degrees of freedom says
    how much more a line takes than the smooth spectrum about it (Thomson 1982, doi:10.1109/PROC.1982.12433, section XIII). A test has
    to hold four cycles; nothing is returned of fewer samples than tell a line.
    """
    n = len(values)
    if n < 8.0 * BANDWIDTH:
        return np.array([]), np.array([])
    time = np.linspace(-1.0, 1.0, n)
    left = values - np.polyval(np.polyfit(time, values, 1), time)
    size = FINER * 2 ** int(np.ceil(np.log2(n)))
    tapers = _tapers(n)
    spectra = np.fft.rfft(tapers * left, size, axis=1)
    sums = tapers.sum(axis=1)
    total = float(sums @ sums)
    line = sums @ spectra / total
    rest = np.sum(np.abs(spectra - np.outer(sums, line)) ** 2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(rest > 0.0, np.abs(line) ** 2 * total / rest, 0.0)
    frequency = np.arange(len(line)) / size
    inside = (frequency >= BANDWIDTH / n) & (frequency <= 0.5 - BANDWIDTH / n)
    return frequency[inside], (1.0 + ratio[inside]) ** (1.0 - TAPERS)


def sine_in(values: Array, frequency: float) -> Array:
    """Return the sine of one frequency, cycles per sample, that fits values (n,) best in addition to a constant, as values (n,)."""
    phase = 2.0 * np.pi * frequency * np.arange(len(values))
    columns = np.column_stack([np.cos(phase), np.sin(phase), np.ones(len(values))])
    amplitudes = np.linalg.lstsq(columns, values, rcond=None)[0]
    return np.asarray(columns[:, :2] @ amplitudes[:2])


def refined(values: Array, frequency: float) -> float:
    """Return the frequency, cycles per sample, near ``frequency`` whose sine fits values (n,) best."""
    from scipy.optimize import minimize_scalar

    near = 1.0 / len(values)
    found = minimize_scalar(
        lambda at: float(np.var(values - sine_in(values, at))),
        bounds=(frequency - near, frequency + near),
        method="bounded",
        options={"xatol": 0.01 * near},
    )
    return float(found.x)


def own_to(frequency: Array, given: Array, level: float) -> NDArray[np.bool_]:
    """Return of which frequencies (f,) no multiple is, nor they of any, at which what is ``given`` (n,) oscillates by itself."""
    others, known = chances(given)
    lines = others[known <= level / max(len(known), 1)]
    near = BANDWIDTH / len(given)
    away = np.ones(len(frequency), dtype=bool)
    for one in lines:
        away &= np.abs(frequency - np.maximum(np.round(frequency / one), 1.0) * one) > near
    return away
