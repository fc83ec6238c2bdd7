r"""Stop drawing twins where what is asked of them is far from its level already.

Twins are exchangeable with the measurement where nothing is missing: the chance that the measurement gains more than all n of
them is 1 / (n + 1), whatever the law of gains. So a gain beyond all of the first `FIRST` twins has p = 0.04 at most, and that is
what is told of it. Drawing on could only take that back. To stop there whenever it happens would add at most 0.8 % to the
5 % of false finds (the union with "at most two of 60 gain more"); so it has to be `FAR` times the largest as well, which
for an exponential tail of gains n twins show in 2 / ((n + 1) (n + 2)) of the nulls: 0.3 %, nearly all of which 60 twins find,
too. The quantile behind `Null.needed` and `Null.limit` is never taken from few twins where it is near what it is compared
with: what is not clear is drawn on, from the same seeds.

Sources: Besag & Clifford (1991), doi:10.1093/biomet/78.2.301; Gandy (2009), doi:10.1198/jasa.2009.tm08368.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FIRST = 24
FAR = 2.0
# In standard deviations of the twins' own errors: about five standard errors of their limit.
APART = 2.0


def is_clear(gain: float, gains: Array) -> bool:
    """Return whether a gain is so far beyond those of enough twins (twins,) that more twins would not change what it says."""
    return len(gains) >= FIRST and gain > FAR * float(np.max(gains)) > 0.0


def is_far(excess: Array, spread: Array) -> bool:
    """Return whether errors over what may be left (channels,) are surely below 1 all of them, or one is surely above.

    ``spread`` (channels,) is the standard deviation of the logarithm of the twins' own errors.
    """
    away = np.log(np.maximum(excess, 1e-30)) / np.maximum(spread, 1e-30)
    return bool(np.any(away > APART) or np.all(away < -APART))
