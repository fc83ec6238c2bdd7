r"""How far a test separates two rivals, one of them true and the other refitted: the analysis's own score, in its scatter.

A true rival A and another one B differ on the windows of a simulated test by features z. B may move its parameters by
:math:`\delta`, held by what the tests so far say of them (H, the information of its fit):

.. math:: \min_\delta \sum_w |W^T (z_w + S_w \delta)|^2 + \delta^T H \delta

with the whitener W of what A leaves of the measured tests. With e the white residuals of A, in their own order, A's advantage is

.. math:: a = \sum_w \tfrac{d}{2} \log \frac{d + |e_w + z_w|^2}{d + |e_w|^2}

as in `hjcamp.diagnosis.validation.blocks.advantages`. The separation is the mean of a over its standard deviation,
over shifts of e in time and both signs.
It is averaged over sets of A's parameters; those of B are averaged by the refit (for Gaussians minimum and mean are the same).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.design.rivals import Rival
from hjcamp.diagnosis.design.truth import joined_with
from hjcamp.diagnosis.estimation.gauss_newton import fit, slopes_of
from hjcamp.diagnosis.estimation.likelihood import whitener
from hjcamp.diagnosis.residuals.windows import Windows

Array = NDArray[np.float64]
SHIFTS = 32
FIT_ROUNDS = 6
LARGEST = 1e6
# Advantages that scatter by less (log units) are no more certain for that: a difference below it is no evidence.
LEAST = 0.7


@dataclass(frozen=True)
class Contest:
    """Rival A true with one set of its parameters, B added to it: white differences (windows, d), their slopes (windows, d, free).

    ``held`` (free, free) is what the tests so far say of B's parameters, ``noise`` (measured windows, d) what A leaves, white,
    ``of_test`` (windows,) the simulated test of each window.
    """

    differences: Array
    slopes: Array
    held: Array
    noise: Array
    of_test: NDArray[np.int64]

    def separation(self, tests: Sequence[int]) -> float:
        """Return the separation by these simulated tests together; 0 where a model diverges on them."""
        rows = np.isin(self.of_test, tests)
        left, worse = self.differences[rows], 0.0
        if not np.all(np.isfinite(left)) or not len(left):
            return 0.0
        if self.slopes.shape[2]:
            slopes = self.slopes[rows].reshape(-1, self.slopes.shape[2])
            square = slopes.T @ slopes + self.held
            step = np.linalg.lstsq(square, -slopes.T @ left.ravel(), rcond=1e-10)[0]
            left = left + (slopes @ step).reshape(left.shape)
            worse = 0.5 * float(step @ self.held @ step)
        return deviate(left, self.noise, worse)


def contests(drawn: Sequence[Windows], truth: Rival, other: Rival) -> list[Contest]:
    """Return the contests of a true rival, simulated with several sets of its parameters, with another one as it was fitted."""
    # a proposed test is judged by predictions: its balances are those of states that nobody has measured yet
    left = drawn[0].layout.predictions(truth.model.features)
    white, noise = whitener(left), left @ whitener(left)
    free, found, slopes = other.model.fitted.free, [], None
    for place, simulated in enumerate(drawn):
        # windows that begin at the same states have the same slopes, whatever was read in them
        same = place > 0 and np.array_equal(simulated.starts, drawn[place - 1].starts)
        if same:
            simulated.place = drawn[place - 1].place._replace(starts=simulated.starts)
        else:
            simulated.renew(other.candidate)
        features = simulated.features(other.candidate)
        if not same or slopes is None:
            slopes = slopes_of(simulated, other.candidate, free, features)
        white_slopes = np.einsum("wfp,fg->wgp", slopes, white)
        found.append(Contest(features @ white, white_slopes, other.model.fitted.information, noise, simulated.layout.of_test))
    return found


def refitted(analysis: Analysis, simulated: Windows, truth: Rival, other: Rival, tests: Sequence[int]) -> float:
    """Return the separation by these tests after B has been fitted to them and all measured tests together."""
    windows, new = joined_with(analysis, other.model.place, simulated, tests)
    free = other.model.fitted.free
    windows.renew(other.candidate)
    left = windows.layout.predictions(truth.model.features)
    white = whitener(left)
    before = windows.features(other.candidate)[~new] @ white
    found = fit(windows, other.candidate, free, FIT_ROUNDS, exact=False)
    if not np.isfinite(found.loss):
        return LARGEST
    if windows.unseen.any():
        windows.move_starts(found.candidate, rounds=1)
        found = fit(windows, found.candidate, free, FIT_ROUNDS, near=found, exact=False)
    # what the new tests cost B on those that are measured counts as well; to those alone it was fitted before
    after = found.features[~new] @ white
    worse = max(float(_scores(after).sum() - _scores(before).sum()), 0.0)
    return deviate(found.features[new] @ white, left @ white, worse)


def deviate(left: Array, noise: Array, worse: float = 0.0) -> float:
    """Return the mean advantage over its standard deviation, for white differences (windows, d) relative to shifts of white noise.

    ``worse`` is what the refit costs on the measured tests, in the same units.
    """
    n = len(left)
    if not np.any(left):
        return 0.0
    places = np.linspace(0, len(noise), SHIFTS, endpoint=False).astype(int)
    sums = []
    for place in places:
        own = noise[(place + np.arange(n)) % len(noise)]
        # with both signs: what a difference and the noise have in common by chance is no separation
        sums += [float(np.sum(_scores(own + sign * left) - _scores(own))) for sign in (1.0, -1.0)]
    spread = float(np.std(sums, ddof=1))
    return float(np.clip((np.mean(sums) + worse) / max(spread, LEAST), 0.0, LARGEST))


def _scores(white: Array) -> Array:
    """Return minus the log score of Student's t (windows,), up to a constant, of white features (windows, d)."""
    d = white.shape[1]
    return np.asarray(0.5 * d * np.log(d + np.sum(white**2, axis=1)))
