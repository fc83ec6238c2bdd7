"""What chance promises: the library's responses against residuals that were shifted (circular shifts, tests exchanged).

A residual that has nothing to do with an effect's response has, circularly shifted, as much in common with it: how far the best effect
of the whole library stands out over such residuals is the null distribution, whatever the form of what is missing
(Politis & Romano 1992; time-shift surrogates, Quian Quiroga et al. 2002, doi:10.1103/PhysRevE.65.041903).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.screening.screening import Probe, Projection

Array = NDArray[np.float64]
DRAWS = 199
# The cube root of a chi-squared variable is nearly normal, whatever its degrees of freedom.
ROOT = 1.0 / 3.0
# A shift under which the motion is much the same again moves nothing.
SIMILAR = 0.5


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
            similar = [rows for rows in tests if len(rows) == length]
            for rows, other in zip(similar, generator.permutation(len(similar)), strict=True):
                shift = int(generator.integers(0, length)) if len(similar) > 1 else int(generator.integers(1, max(length, 2)))
                order[rows] = np.roll(similar[other], shift)
        agreement = float(np.mean(centred * centred[order]))
        if abs(agreement) < SIMILAR:
            found.append(order)
        if len(found) == draws:
            break
    return found


class Chance(NamedTuple):
    """How far the best effect stands out of what chance promises of it, and what chance promises: see `chance_gains`.

    ``usual`` is the median of the largest gain of all by chance (log-likelihood); ``own`` the mean and the deviation of the cube root
    of what each effect takes by chance.
    """

    gain: float
    shifted: Array
    decoys: Array
    replicates: Array
    usual: float
    own: Mapping[str, tuple[float, float]]

    def stands_out(self, effect: str, taken: float) -> float:
        """Return by how many standard deviations what an effect takes (log-likelihood) is more than it takes by chance."""
        centre, spread = self.own.get(effect, (0.0, 0.0))
        return (max(taken, 0.0) ** ROOT - centre) / spread if spread > 0.0 else 0.0


def chance_gains(projection: Projection, probes: Sequence[Probe], orders: Sequence[NDArray[np.int64]], seed: int) -> Chance:
    r"""Return how far the best effect stands out against the real residuals, and against those in each of the orders (orders,).

    .. math:: \max_e \frac{S_e^{1/3} - m_e}{s_e}, \quad S_e = \max_{probes\ of\ e} \tfrac12 |B^T r|^2

    with the mean and deviation of each effect's own root over all of these: laws of one knot and of 48, and residuals that hang
    together, are so on one scale (Westfall & Young 1993; Wilson & Hilferty 1931, doi:10.1073/pnas.17.12.684). Further, for as many
    each: that of decoys, a library with each effect's response shifted by itself; and that of replicates, whose residuals
    are drawn from a normal law with the second moments of the real ones.
    """
    left, generator = projection.fitted.features, np.random.default_rng((seed, 271))
    drawn = generator.standard_normal((*left.shape, len(orders)))
    stacked = np.stack([left, *(left[order] for order in orders)], axis=2)
    moved = projection.free_of_base(stacked)
    replicates = projection.free_of_white(drawn)
    # each moved residual is as large as the real one
    columns = np.concatenate([moved, replicates], axis=1)
    columns = columns * (np.linalg.norm(columns[:, 0]) / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))
    count = len(orders)
    best = np.zeros(columns.shape[1])
    taken: dict[str, Array] = {}
    for probe in probes:
        basis = projection.basis(probe)
        if not basis.shape[1]:
            continue
        found = basis.T @ columns
        each = 0.5 * np.sum(found**2, axis=0)
        if probe.one_sided and basis.shape[1] == 1:
            direction = float(np.sign((projection.free_of_base(probe.responses)[:, 0] @ basis)[0]))
            each = np.where(-direction * found[0] > 0.0, each, 0.0)
        best = np.maximum(best, each - basis.shape[1] + 1.0)
        taken[probe.effect] = np.maximum(taken.get(probe.effect, 0.0), each)
    roots = {name: each**ROOT for name, each in taken.items()}
    own = {name: (float(one[: count + 1].mean()), float(one[: count + 1].std())) for name, one in roots.items()}
    apart = {name: (one - own[name][0]) / own[name][1] for name, one in roots.items() if own[name][1] > 0.0}
    # where chance promises nothing at all, nothing stands out
    largest = np.max(list(apart.values()), axis=0) if apart else np.zeros(columns.shape[1])
    mixed = [one[1 : count + 1][generator.permutation(count)] for one in apart.values()]
    decoys = np.max(mixed, axis=0) if mixed else np.zeros(count)
    usual = float(np.median(best[1 : count + 1])) if count else 0.0
    return Chance(float(largest[0]), largest[1 : count + 1], decoys, largest[count + 1 :], usual, own)


def p_value(gain: float, chance: Array) -> float:
    """Return the share of chance gains that are as large, the real one counted in (Davison & Hinkley 1997, section 4.2)."""
    return (1.0 + float(np.sum(chance >= gain))) / (1.0 + len(chance))
