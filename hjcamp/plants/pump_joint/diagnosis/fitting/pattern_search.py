"""Settle a fit where slips make the error rough: move one unknown after the other, and keep what helps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import Unknown, read, written

FIRST, LAST = 1.5, 0.18
FARTHEST = 0.3
WORTHLESS = 0.2


def settle(fitter: Fitter, fit: Fit, unknowns: Sequence[Unknown], sweeps: int) -> Fit:
    """Return ``fit`` after a pattern search of at most ``sweeps`` over all unknowns, never with a larger loss.

    Steps begin at 1.5 standard deviations of each unknown alone and grow by 1.3 where they help, shrink by 2 where they
    do not. Slips move in time by leaps, so that derivatives lead nowhere near the end.
    Source: Hooke & Jeeves (1961), doi:10.1145/321062.321069.
    """
    if sweeps < 1 or not unknowns:
        return fit
    best = fit
    jacobian = fitter.jacobian(fit, unknowns)
    known = np.array([unknown.spread for unknown in unknowns]) ** -2.0
    squares = np.einsum("kbc,bc,kbc->k", jacobian, fitter.weights(fit.mean_square), jacobian)
    unit = np.minimum((squares + known + 0.5) ** -0.5, FARTHEST / FIRST)
    size, side = np.full(len(unknowns), FIRST), np.ones(len(unknowns))
    idle = 0
    for _ in range(sweeps):
        before = best.loss
        for index in np.argsort(-size, kind="stable"):
            if size[index] <= LAST:
                continue
            places = read(best.candidate, unknowns)
            for sign in (side[index], -side[index]):
                moved = places.copy()
                moved[index] += sign * size[index] * unit[index]
                found = fitter.look(written(best.candidate, unknowns, moved))
                if found.loss < best.loss:
                    best, side[index] = found, sign
                    size[index] *= 1.3
                    break
            else:
                size[index] *= 0.5
        idle = idle + 1 if before - best.loss < WORTHLESS else 0
        if idle == 2 or np.all(size <= LAST):
            break
    return best
