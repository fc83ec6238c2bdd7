"""The step of a Gauss-Newton method within bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Directions of less curvature than this share of the largest are no directions of a step.
FLAT = 1e-12
# Correlations are 1 at most, but for this.
ROUNDING = 1e-6
# No parameter moves further than this in one step, in units of its scale (its logarithm where it is fitted so).
FARTHEST = 2.0


def bounded_step(curvature: Array, downhill: Array, low: Array, high: Array) -> Array:
    r"""Return the step (p,) that makes a quadratic least within bounds.

    .. math:: \min_x \tfrac12 x^T H x - g^T x, \quad low \le x \le high, \quad |x_k| \le 2

    for the curvature H (p, p) and the downhill slope g (p,). What stands at a bound and pulls outwards stays there, and the others
    move as is best with it; a step that is cut at the bound afterwards leads the others astray. Bounds are of the step, so that
    ``low`` is not above 0 and ``high`` not below (Stark & Parker 1995, Bounded-variable least-squares).
    """
    if not len(downhill) or not np.all(np.isfinite(curvature)) or not np.all(np.isfinite(downhill)):
        return np.zeros(len(downhill))
    # in units in which each parameter has the same curvature
    own = np.diag(curvature)
    size = np.sqrt(np.maximum(own, 1e-300))
    with np.errstate(over="ignore"):
        shared = curvature / np.outer(size, size)
    # what is left of a curvature where nothing tells a parameter is rounding: below 0, or less than what it shares with another
    flat = (own <= 0.0) | np.any((np.abs(shared) > 1.0 + ROUNDING) & (own[:, None] <= own), axis=1)
    shared[flat, :] = shared[:, flat] = 0.0
    values, vectors = np.linalg.eigh(shared)
    kept = values > FLAT * max(float(values[-1]), 1e-300)
    root = np.sqrt(values[kept])
    rows, aims = root[:, None] * vectors[:, kept].T, vectors[:, kept].T @ (downhill / size) / root
    least, most = np.maximum(low, -FARTHEST) * size, np.minimum(high, FARTHEST) * size
    free = most - least > 0.0
    found = np.zeros(len(downhill))
    if free.any():
        found[free] = _within(rows[:, free], aims, least[free], most[free])
    return found / size


def _within(rows: Array, aims: Array, least: Array, most: Array) -> Array:
    """Return x (p,) with least squares of rows x - aims between ``least`` and ``most`` (p,); bounds are seldom met."""
    found = np.asarray(np.linalg.lstsq(rows, aims, rcond=-1)[0])
    if np.all((found >= least) & (found <= most)):
        return found
    from scipy.optimize import lsq_linear

    return np.asarray(lsq_linear(rows, aims, (least, most), method="bvls").x)
