r"""How far a set of tests separates rivals, each refitted, from products that are computed once for each test.

Where rival A is the truth, what is left of rival B after its base and effect parameters have been refitted, linearised, on
the measured tests and the proposed ones together, is

.. math:: D = \frac{R}{r} \sum_{tests, channels} \log \frac{e_B^2 + l^2}{e_A^2 + l^2}

with mean square errors e, the floor-based least l of the diagnosis, r simulated and R planned repetitions. The separation is
D over the scatter of its terms from repetition to repetition: the deviate by which a diagnosis weighs rivals.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.design.responses import Products, Responses
from hjcamp.plants.pump_joint.diagnosis.design.rivals import Rival
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter

Array = NDArray[np.float64]
LEAST_ERROR = 0.7
LEAST_GAIN = 0.1


@dataclass(frozen=True)
class Contest:
    """One ordered pair of rivals (positions): ``truth`` is so, ``other`` is refitted.

    ``new`` and ``true_loss`` (tests,) belong to the simulated tests, ``old`` to the measured ones.
    """

    truth: int
    other: int
    weight: float
    new: Products
    true_loss: Array
    old: Products | None = None


class Arena:
    """All contests on all simulated tests: trial k has the tests k r ... k r + r - 1, to be repeated R times."""

    def __init__(self, contests: Sequence[Contest], least: Array, simulated: int, planned: int) -> None:
        self.contests, self.least = list(contests), least
        total = sum(contest.weight for contest in contests)
        self._weights = np.array([contest.weight / total for contest in contests])
        self.simulated, self.planned = simulated, planned
        self._scatter = [self._spread(contest) for contest in self.contests]

    def _tests(self, trials: Sequence[int]) -> list[int]:
        return [trial * self.simulated + number for trial in trials for number in range(self.simulated)]

    def _differences(self, contest: Contest, trials: Sequence[int]) -> tuple[Array, float]:
        """Return the terms of D of the new tests (tests,), and by how much the refit worsens the measured ones."""
        chosen = self._tests(trials)
        new = contest.new.rows(chosen)
        weight = np.full(len(chosen), self.planned / self.simulated)
        if contest.old is None:
            return new.losses(self.least, weight) - contest.true_loss[chosen], 0.0
        old = np.ones(len(contest.old.square))
        alone = contest.old.losses(self.least, old).sum()
        both = contest.old.beside(new).losses(self.least, np.concatenate([old, weight]))
        return both[len(old) :] - contest.true_loss[chosen], float(both[: len(old)].sum() - alone)

    def _spread(self, contest: Contest) -> float:
        terms = (contest.new.losses(self.least, np.ones(len(contest.true_loss))) - contest.true_loss).reshape(
            -1, self.simulated
        )
        return float(np.sqrt(np.mean(np.var(terms, axis=1, ddof=1)))) if self.simulated > 1 else LEAST_ERROR

    def separation(self, number: int, trials: Sequence[int]) -> float:
        """Return the separation (standard deviations, at least 0) of one contest by these trials together."""
        if not trials:
            return 0.0
        terms, worse = self._differences(self.contests[number], trials)
        total = terms.sum() * self.planned / self.simulated + worse
        error = self._scatter[number] * np.sqrt(len(trials) * self.planned)
        return float(max(total, 0.0) / max(error, LEAST_ERROR))

    def score(self, trials: Sequence[int]) -> float:
        """Return what a set of trials is worth: pairs that are still alike count more than those already apart."""
        apart = [self.separation(number, trials) for number in range(len(self.contests))]
        return float(np.dot(self._weights, np.log1p(apart)))

    def pairs(self, trials: Sequence[int]) -> dict[tuple[int, int], float]:
        """Return the separation of each pair of rivals, whichever of the two is true."""
        found: dict[tuple[int, int], float] = {}
        for number, contest in enumerate(self.contests):
            key = (min(contest.truth, contest.other), max(contest.truth, contest.other))
            apart = self.separation(number, trials)
            found[key] = min(found.get(key, apart), apart)
        return found


def choose(arena: Arena, costs: Sequence[float], tests: int) -> list[int]:
    """Return the trials that separate best, picked one after the other; fewer where no further one adds anything."""
    chosen: list[int] = []
    before = 0.0
    while len(chosen) < min(tests, len(costs)):
        left = [trial for trial in range(len(costs)) if trial not in chosen]
        gains = {trial: (arena.score([*chosen, trial]) - before) / costs[trial] for trial in left}
        best = max(gains, key=lambda trial: gains[trial])
        if gains[best] <= LEAST_GAIN:
            break
        chosen.append(best)
        before = arena.score(chosen)
    return chosen


def loss_of(fit: Fit, least: Array) -> Array:
    """Return the loss (tests,) of a rival as it is."""
    return np.asarray(np.log(fit.mean_square + least**2).sum(axis=1))


def every_contest(
    rivals: Sequence[Rival],
    truths: Sequence[Candidate],
    fitters: Sequence[Fitter],
    effects: Sequence[type[Effect]],
    old: Sequence[Responses],
    tick: Callable[[], None],
) -> list[Contest]:
    """Return all ordered pairs; ``fitters`` hold, rival by rival, the tests on which its ``truths`` are the truth.

    ``old`` are the rivals' responses on the measured tests, empty where there are none.
    """
    contests = []
    least = fitters[0].least
    before = [one.products() for one in old]
    for truth, fitter in enumerate(fitters):
        own = loss_of(fitter.look(truths[truth]), least)
        for other, rival in enumerate(rivals):
            if other == truth:
                continue
            new = Responses.of(fitter, rival.candidate, effects).products()
            weight = rivals[truth].posterior * rival.posterior
            contests.append(Contest(truth, other, weight, new, own, before[other] if before else None))
            tick()
    return contests


def contests_with_nothing(
    rivals: Sequence[Rival], fitter: Fitter, effects: Sequence[type[Effect]], tick: Callable[[], None]
) -> list[Contest]:
    """Return one contest for each effect: it is the truth, and "nothing" (the first rival, true in the tests) is refitted.

    The effect is put into the residual of the tests as its own response, so that one set of tests serves all.
    """
    nothing = Responses.of(fitter, rivals[0].candidate, effects)
    own = loss_of(nothing.seen, fitter.least)
    contests = []
    for truth, rival in enumerate(rivals[1:], start=1):
        effect = fitter.look(rival.candidate).features - nothing.seen.features
        residual = nothing.seen.features - effect
        contests.append(Contest(truth, 0, rival.posterior, nothing.products(residual), own))
        tick()
    return contests
