"""Propose tests: simulate the menu with every rival, refit the others, and choose what sets them apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.design.beyond import Beyond, beyond, ranges
from hjcamp.diagnosis.design.menu import DEARER, menu
from hjcamp.diagnosis.design.rivals import Question
from hjcamp.diagnosis.design.separation import Contest, contests, refitted
from hjcamp.diagnosis.design.truth import bench_of, held_by_loop
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.diagnosis.residuals.windows import Windows

Array = NDArray[np.float64]
Report = Callable[[str, float], None]
#: Whether a test can be made: what is wanted, and whether tests are motions here.
Makeable = Callable[[Wanted, bool], bool]
Pairs = dict[tuple[int, int], float]
REFITTED = 5
# Below this, in standard deviations, a test does not tell two rivals apart.
APART = 3.0
# A further test is worth its time where the score of all rises by so much.
LEAST_GAIN = 0.1
# Windows of a proposed test: half a usual analysis.
WINDOWS = 48
# No test is proposed that leaves what the logs visited by more than this share of its range.
FARTHEST = 0.5
BEYOND = 0.05


@dataclass(frozen=True)
class Proposed:
    """A test that could be made: separation of each pair after a real refit, by the linear one, and what leaves the logs' ranges.

    ``of`` is the measured test that it is made from; separations are of one run of ``seconds``, ``repetitions`` are as in the logs.
    """

    wanted: Wanted
    of: str
    repetitions: int
    place: int
    seconds: float
    pairs: Pairs
    linear: Pairs
    beyond: tuple[Beyond, ...]


@dataclass(frozen=True)
class Proposal:
    """The best tests, those that are worth it first (``chosen`` of them), and the separation by these together."""

    question: Question
    tests: tuple[Proposed, ...]
    chosen: int
    together: Pairs
    tried: int
    by_motion: bool
    truths: tuple[tuple[Windows, ...], ...]

    @property
    def best(self) -> float:
        """The largest separation of any pair by one test."""
        return max((value for one in self.tests for value in one.pairs.values()), default=0.0)


def propose(
    analysis: Analysis,
    question: Question,
    tests: int = 3,
    report: Report = lambda text, share: None,
    makeable: Makeable = lambda wanted, by_motion: True,
) -> Proposal:
    """Return the tests of the menu that separate the rivals best, at most ``tests`` of them worth making."""
    rivals, layout = question.rivals, analysis.windows.layout
    by_motion = held_by_loop(analysis)
    if not question.contests:
        return Proposal(question, (), 0, {}, 0, by_motion, ())
    samples = layout.width * int(
        np.clip(np.median([test.samples // layout.width for test in analysis.measured.tests]), 1, WINDOWS)
    )
    wanted = [one for one in menu(analysis.measured, samples, by_motion) if makeable(one, by_motion)]
    if not wanted:
        return Proposal(question, (), 0, {}, 0, by_motion, ())
    report("finding what the motions need", 0.05)
    bench = bench_of(analysis, wanted, rivals[0].candidate, by_motion)
    truths = []
    for k, rival in enumerate(rivals):
        report(f"simulating {len(wanted)} tests with {rival.name}", 0.1 + 0.2 * k / len(rivals))
        own = (rival.candidate, *rival.draws)
        truths.append(tuple(bench.simulated(analysis, one) for one in own))
    outside = beyond(analysis, bench, [one[0] for one in truths], ranges(analysis))
    able = [
        k
        for k in range(len(wanted))
        if all(each.share <= FARTHEST for each in outside[k]) and all(_stays(one[0], k) for one in truths)
    ]
    fights = _contests(question, truths, report)
    singles = {k: _pairs(question, fights, [k]) for k in able}
    costs = {k: _cost(wanted[k], outside[k]) for k in able}
    best = sorted(able, key=lambda k: -_score(singles[k]) / costs[k])[:REFITTED]
    usual = int(np.median([len(places) for places in layout.measured.conditions.values()]))
    found, seconds = [], samples * layout.measured.period
    for done, k in enumerate(best):
        report(f"refitting on {wanted[k].text}", 0.7 + 0.25 * done / len(best))
        pairs = _refitted(analysis, question, truths, [k])
        of = layout.measured.tests[wanted[k].of].name
        found.append(Proposed(wanted[k], of, usual, k, seconds, pairs, singles[k], tuple(outside[k])))
    found.sort(key=lambda one: -_score(one.pairs) / costs[one.place])
    chosen, together = _chosen(analysis, question, truths, fights, found, tests)
    rest = [one for one in found if one not in chosen]
    return Proposal(question, (*chosen, *rest), len(chosen), together, len(able), by_motion, tuple(truths))


def _stays(simulated: Windows, test: int) -> bool:
    """Whether a rival does not diverge in a test, not in its last window either."""
    layout = simulated.layout
    return bool(np.isfinite(layout.readings[np.repeat(layout.of_test, layout.width) == test]).all())


def _contests(question: Question, truths: Sequence[Sequence[Windows]], report: Report) -> dict[tuple[int, int], list[Contest]]:
    found: dict[tuple[int, int], list[Contest]] = {}
    for done, (true, other) in enumerate(question.contests):
        one, two = question.rivals[true], question.rivals[other]
        report(f"setting {one.name} against {two.name}", 0.3 + 0.4 * done / len(question.contests))
        found[true, other] = contests(truths[true][1:], one, two)
    return found


def _pairs(question: Question, contests: dict[tuple[int, int], list[Contest]], tests: Sequence[int]) -> Pairs:
    """Return the separation of each pair, the mean over draws, whichever of the two is true: the smaller."""
    each = {key: float(np.mean([one.separation(tests) for one in those])) for key, those in contests.items()}
    return _smaller(question, each)


def _refitted(analysis: Analysis, question: Question, truths: Sequence[Sequence[Windows]], tests: Sequence[int]) -> Pairs:
    rivals = question.rivals
    each = {
        (true, other): refitted(analysis, truths[true][0], rivals[true], rivals[other], tests)
        for true, other in question.contests
    }
    return _smaller(question, each)


def _smaller(question: Question, each: dict[tuple[int, int], float]) -> Pairs:
    return {(a, b): min(each[key] for key in ((a, b), (b, a)) if key in each) for a, b in question.pairs}


def _score(pairs: Pairs) -> float:
    """Return what separations are worth: a pair that is still similar counts more than one that is apart already."""
    return float(np.mean([np.log1p(value) for value in pairs.values()])) if pairs else 0.0


def _cost(wanted: Wanted, outside: Sequence[Beyond]) -> float:
    return max(wanted.cost, DEARER if any(one.share > BEYOND for one in outside) else 1.0)


def _chosen(
    analysis: Analysis,
    question: Question,
    truths: Sequence[Sequence[Windows]],
    contests: dict[tuple[int, int], list[Contest]],
    found: Sequence[Proposed],
    tests: int,
) -> tuple[list[Proposed], Pairs]:
    """Return the tests that are worth making, one after the other, and their separation together; none where none separates."""
    able = [one for one in found if max(one.pairs.values(), default=0.0) >= APART]
    chosen = able[:1]
    while chosen and len(chosen) < tests:
        places = [one.place for one in chosen]
        before = _score(_pairs(question, contests, places))
        gains = {
            one.place: _score(_pairs(question, contests, [*places, one.place])) - before for one in able if one not in chosen
        }
        best = max(gains, key=lambda place: gains[place], default=None)
        if best is None or gains[best] <= LEAST_GAIN:
            break
        chosen.append(next(one for one in able if one.place == best))
    if len(chosen) < 2:
        return chosen, (chosen[0].pairs if chosen else {})
    return chosen, _refitted(analysis, question, truths, [one.place for one in chosen])
