"""What chance promises: the library's responses beside residuals that were moved in time (circular shifts, tests exchanged).

A residual that has nothing to do with an effect's response has, moved in time, as much in common with it: the largest gain of
the whole library over such residuals is the null distribution, whatever the form of what is missing
(Politis & Romano 1992; time-shift surrogates, Quian Quiroga et al. 2002, doi:10.1103/PhysRevE.65.041903).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.screening.screening import Probe, Projection

Array = NDArray[np.float64]
DRAWS = 199
# A shift under which the motion is much the same again moves nothing.
ALIKE = 0.5


def moved_orders(of_test: NDArray[np.int64], motion: Array, seed: int, draws: int = DRAWS) -> list[NDArray[np.int64]]:
    """Return orders of the windows (windows,): tests of equal length exchanged, each test's windows shifted in a circle.

    ``motion`` (windows, m) describes each window's measured motion; orders under which it agrees with itself are left out.
    """
    generator = np.random.default_rng((seed, 199))
    tests = [np.flatnonzero(of_test == test) for test in np.unique(of_test)]
    centred = (motion - motion.mean(axis=0)) / np.maximum(motion.std(axis=0), 1e-300)
    found: list[NDArray[np.int64]] = []
    for _ in range(20 * draws):
        order = np.empty(len(of_test), dtype=np.int64)
        lengths = {len(rows) for rows in tests}
        for length in lengths:
            alike = [rows for rows in tests if len(rows) == length]
            for rows, other in zip(alike, generator.permutation(len(alike)), strict=True):
                shift = (
                    int(generator.integers(0, length)) if len(alike) > 1 else int(generator.integers(1, max(length, 2)))
                )
                order[rows] = np.roll(alike[other], shift)
        agreement = float(np.mean(centred * centred[order]))
        if abs(agreement) < ALIKE:
            found.append(order)
        if len(found) == draws:
            break
    return found


class Chance(NamedTuple):
    """The largest gain that the library promises, and what it promises where nothing is: see `chance_gains`."""

    gain: float
    shifted: Array
    decoys: Array
    twins: Array


def chance_gains(
    projection: Projection, probes: Sequence[Probe], orders: Sequence[NDArray[np.int64]], seed: int
) -> Chance:
    """Return the largest linear gain of the probes, and that beside residuals in each of the orders (orders,).

    Beside it, for as many each: that of decoys, a library of which each effect's response is moved in time by itself; and that of
    twins, whose residuals are drawn from a normal law with the second moments of the real ones.
    """
    left, generator = projection.fitted.features, np.random.default_rng((seed, 271))
    drawn = generator.standard_normal((*left.shape, len(orders)))
    stacked = np.stack([left, *(left[order] for order in orders)], axis=2)
    moved = projection.free_of_base(stacked)
    twins = projection.free_of_white(drawn)
    # each moved residual is as large as the real one
    columns = np.concatenate([moved, twins], axis=1)
    columns = columns * (np.linalg.norm(columns[:, 0]) / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))
    count = len(orders)
    best, decoys = np.zeros(columns.shape[1]), np.zeros(count)
    mixed: dict[str, NDArray[np.int64]] = {}
    for probe in probes:
        basis = projection.basis(probe)
        if not basis.shape[1]:
            continue
        found = basis.T @ columns
        gains = 0.5 * np.sum(found**2, axis=0) - basis.shape[1] + 1.0
        if probe.one_sided and basis.shape[1] == 1:
            direction = float(np.sign((projection.free_of_base(probe.responses)[:, 0] @ basis)[0]))
            gains = np.where(-direction * found[0] > 0.0, gains, 0.0)
        best = np.maximum(best, gains)
        own = mixed.setdefault(probe.effect, generator.permutation(count))
        decoys = np.maximum(decoys, gains[1 : count + 1][own])
    return Chance(float(best[0]), best[1 : count + 1], decoys, best[count + 1 :])


def p_value(gain: float, chance: Array) -> float:
    """Return the share of chance gains that are as large, the real one counted in (Davison & Hinkley 1997, section 4.2)."""
    return (1.0 + float(np.sum(chance >= gain))) / (1.0 + len(chance))
