r"""Intervals by likelihood ratio: one parameter is held, all others are fitted again.

.. math:: R(x) = 2 \frac{H^{-1}_{pp}}{V_{pp}} \frac{\chi^2_{1, 0.95}}{t^2_{B - 1, 0.975}}
          \bigl(\min_{\theta: \theta_p = x} \ell(\theta) - \ell(\hat\theta)\bigr) \le \chi^2_{1, 0.95}

The first factor, inverse curvature H over the covariance V with the B blocks as clusters, gives the loss the curvature of what is
known: it is below 1 where windows repeat each other, and above 1 where the sensors' noise, which the loss adds to what it is in the
features already, makes the loss too flat (Chandler & Bate 2007, doi:10.1093/biomet/asm015; Varin, Reid & Firth 2011, section 2.3). The
second is for V being estimated from B blocks. Starts of windows stay where the whole fit has put them. Source of the profile: Raue et
al. 2009, doi:10.1093/bioinformatics/btp358.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free, fit
from hjcamp.diagnosis.estimation.intervals import covariance_of
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
# Steps to one side, each in standard deviations of the quadratic interval, and by how much they grow: 0.7 to 200 of them.
STEPS, FIRST, GROWTH = 9, 0.7, 2.0
ROUNDS = 10
# One fit more where two neighbours of the end are further apart.
FINE = 1.5


@dataclass(frozen=True)
class Profile:
    """The rise of the loss over a parameter: ``values`` (k,), SI, with ``rise`` (k,), twice the adjusted log-likelihood ratio.

    ``low`` and ``high`` are the ends of the interval, None where the tests do not bound it on that side: up to ``bounds`` the loss
    does not rise enough.
    """

    free: Free
    value: float
    values: Array
    rise: Array
    low: float | None
    high: float | None

    @property
    def name(self) -> str:
        """The parameter, with its effect."""
        return f"{self.free.effect} {self.free.name}".strip()

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds that the parameter has by itself, SI."""
        return self.free.low, self.free.high

    @property
    def flat(self) -> bool:
        """Whether the tests bound it on neither side."""
        return self.low is None and self.high is None

    @property
    def words(self) -> str:
        """What the tests do not say of the parameter; empty where they bound it on both sides."""
        if self.flat:
            return f"these tests do not identify '{self.name}': {self._ends} is as likely as its value"
        side = "above" if self.high is None else "below"
        return "" if self.low is not None and self.high is not None else f"these tests do not bound '{self.name}' from {side}"

    @property
    def _ends(self) -> str:
        known = [f"{one:.4g}" for one in (self.values.min(), self.values.max())]
        return f"anything from {known[0]} to {known[1]}"


def limit() -> float:
    """Return how much the adjusted ratio rises to the end of a 95 % interval."""
    from scipy.special import chdtri

    return float(chdtri(1, LEVEL))


def profiles(windows: Windows, fitted: Fitted, blocks: NDArray[np.int64], names: set[tuple[str, str]]) -> Iterator[Profile]:
    """Yield the profile of each free parameter that ``names`` has as (effect, name)."""
    from scipy.special import stdtrit

    if fitted.place is not None:
        windows.place = fitted.place
    fitted = fitted.of_readings
    found = covariance_of(fitted, blocks)
    naive = np.diag(np.linalg.pinv(fitted.information))
    spread = np.sqrt(np.maximum(np.diag(found.readings), 0.0))
    few = limit() / float(stdtrit(max(len(np.unique(blocks)), 2) - 1, 1.0 - LEVEL / 2.0)) ** 2
    for k, one in enumerate(fitted.free):
        if (one.effect, one.name) in names:
            told = bool(found.told[k]) and spread[k] > 0.0
            factor = float(naive[k] / spread[k] ** 2) * few if told else 1.0
            usual = float(spread[k]) if told else _room(one, fitted) / (FIRST * GROWTH**STEPS)
            yield _profile(windows, fitted, k, usual, factor)


def _room(one: Free, fitted: Fitted) -> float:
    """Return how far a parameter can go within its bounds, or a hundred times its size, in units of its scale."""
    x = one.of(fitted.candidate)
    ends = [one.of(one.put(fitted.candidate, end)) for end in (-math.inf, math.inf)]
    return float(min(max(abs(end - x) for end in ends), 100.0 * max(abs(x), 1.0)))


def _profile(windows: Windows, fitted: Fitted, k: int, usual: float, factor: float) -> Profile:
    one, x = fitted.free[k], fitted.free[k].of(fitted.candidate)
    sides = [_side(windows, fitted, k, sign * usual, factor) for sign in (-1.0, 1.0)]
    rows = sorted([(x, 0.0), *(row for side in sides for row in side)])
    values = [math.exp(at) if one.log else at * one.scale for at, _ in rows]
    ends = [_end(x, side) for side in sides]
    low, high = (None if at is None else math.exp(at) if one.log else at * one.scale for at in ends)
    return Profile(one, one.value_in(fitted.candidate), np.array(values), np.array([rise for _, rise in rows]), low, high)


def _side(windows: Windows, fitted: Fitted, k: int, step: float, factor: float) -> list[tuple[float, float]]:
    """Return the places (in units of the scale) and rises to one side, up to the first beyond the end, or the bound."""
    one, others = fitted.free[k], [each for j, each in enumerate(fitted.free) if j != k]
    x, before, near, found = one.of(fitted.candidate), fitted, fitted, []
    at, reach = x, FIRST * step
    for _ in range(STEPS):
        aim = x + reach
        if (
            not one.log and one.low >= 0.0 and at > 0.0
        ):  # the others follow a size that is halved, not one that vanishes at once
            aim = max(aim, 0.5 * at)
        held = one.into(near.candidate, aim)
        if abs(one.of(held) - at) < 1e-9 * max(abs(at), 1e-9):
            break  # the bound
        at = one.of(held)
        ahead = _ahead(before.candidate, near.candidate, held, one, others)
        begun = min((held, ahead), key=lambda start: loss(windows.along(start)))
        before, near = near, fit(windows, begun, others, rounds=ROUNDS, near=near, exact=False)
        rise = _rise(near, fitted, factor)
        found.append((at, rise))
        if rise > limit():
            break
        reach *= GROWTH
    return _refined(windows, fitted, k, found, factor)


def _ahead(before: Candidate, now: Candidate, held: Candidate, one: Free, others: Sequence[Free]) -> Candidate:
    """Return the next place with the other parameters moved on as they went last, each by a power of the one that is held."""
    sizes = [one.value_in(each) for each in (before, now, held)]
    if min(sizes) <= 0.0 or sizes[0] == sizes[1]:
        return held
    power = math.log(sizes[2] / sizes[1]) / math.log(sizes[1] / sizes[0])
    for other in others:
        first, last = other.value_in(before), other.value_in(now)
        if first > 0.0 and last > 0.0 and abs(math.log(last / first) * power) < 100.0:
            held = other.put(held, last * (last / first) ** power)
    return held


def _rise(found: Fitted, fitted: Fitted, factor: float) -> float:
    """Return twice the adjusted log-likelihood ratio of a fit; infinite where the model diverges."""
    return max(2.0 * factor * (found.loss - fitted.loss), 0.0) if np.isfinite(found.loss) else math.inf


def _refined(
    windows: Windows, fitted: Fitted, k: int, found: list[tuple[float, float]], factor: float
) -> list[tuple[float, float]]:
    """Add a place near the end where the last step has gone far beyond it."""
    x = fitted.free[k].of(fitted.candidate)
    end = _end(x, found)
    if end is None or not found or abs(found[-1][0] - end) * FINE < abs(end - x) * 0.1:
        return found
    others = [each for j, each in enumerate(fitted.free) if j != k]
    held = fitted.free[k].into(fitted.candidate, end)
    near = fit(windows, held, others, rounds=ROUNDS, near=fitted, exact=False)
    rows = [*found, (fitted.free[k].of(held), _rise(near, fitted, factor))]
    return sorted(rows, key=lambda row: abs(row[0] - x))


def _end(x: float, side: list[tuple[float, float]]) -> float | None:
    """Return where the ratio passes the limit, on a line through the roots of its neighbours; None where it does not."""
    before, most = (x, 0.0), limit()
    for row in side:
        if row[1] > most:
            low, high = math.sqrt(before[1]), math.sqrt(min(row[1], 1e6))
            return float(before[0] + (row[0] - before[0]) * (math.sqrt(most) - low) / (high - low))
        before = row
    return None
