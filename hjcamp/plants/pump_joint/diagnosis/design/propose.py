"""Propose the next tests: those of the rig's menu that separate the rivals best, each refitted, against the floor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice, menu
from hjcamp.plants.pump_joint.diagnosis.design.responses import Responses
from hjcamp.plants.pump_joint.diagnosis.design.rivals import Rival
from hjcamp.plants.pump_joint.diagnosis.design.separation import Arena, choose, contests_with_nothing, every_contest
from hjcamp.plants.pump_joint.diagnosis.design.trials import Bench, Trial
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fitter
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence, TestEvidence
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
SIMULATED = 2
REPETITIONS = 3
ALL_PAIRS = 6
HALF_FLOOR = 0.5
Report = Callable[[str, float], None]


@dataclass(frozen=True)
class Proposed:
    """One chosen test: the separation (standard deviations) of each pair of rivals by it alone."""

    trial: Trial
    pairs: dict[tuple[int, int], float]


@dataclass(frozen=True)
class Proposal:
    """The chosen tests in the order of their worth, and the separation of each pair by all of them together."""

    rivals: list[Rival]
    tests: list[Proposed]
    together: dict[tuple[int, int], float]
    tried: int


def weighted(separations: dict[tuple[int, int], float], rivals: Sequence[Rival]) -> float:
    """Return the mean separation of the pairs, weighed with how likely the pair is."""
    weights = [rivals[one].posterior * rivals[other].posterior for one, other in separations]
    return float(np.average(list(separations.values()), weights=weights)) if separations else 0.0


def propose(
    rivals: Sequence[Rival],
    bench: Bench,
    *,
    tests: int = 3,
    repetitions: int = REPETITIONS,
    measured: Fitter | None = None,
    choices: Sequence[Choice] | None = None,
    seed: int = 1,
    crew: Crew | None = None,
    report: Report = lambda text, share: None,
) -> Proposal:
    """Return the tests of the menu that separate the rivals best.

    ``measured`` holds the tests that there are already: they bound how far a rival can be refitted. With more than
    six rivals the first must be "nothing", and the others are set apart from it alone. The same seed gives the same answer.
    """
    crew = crew or Crew()
    rivals = list(rivals)
    truths = rivals if len(rivals) <= ALL_PAIRS else rivals[:1]
    report("composing the menu", 0.0)
    trials = [trial for trial in map(bench.trial, menu() if choices is None else choices) if trial is not None]
    done = [0]
    steps = len(truths) + (len(truths) * (len(rivals) - 1) if len(truths) > 1 else len(rivals) - 1)

    def tick(text: str) -> None:
        done[0] += 1
        report(text, 0.05 + 0.9 * done[0] / steps)

    old: list[Responses] = []
    if measured is not None and len(truths) > 1:
        old = [Responses.of(measured, rival.candidate, bench.effects) for rival in rivals]
    models = [one.largest(bench.effects) for one in old] or [rival.candidate for rival in truths]
    simulated = []
    for rival, model in zip(truths, models, strict=True):
        simulated.append(_simulate(bench, trials, model, seed, crew))
        tick(f"simulating {len(trials)} tests with {rival.name}")
    kept = [k for k in range(len(trials)) if all(tests_of[k] is not None for tests_of in simulated)]
    if not kept:
        raise UsageError("no test of the menu stays within the limits of this rig; see `limits` of its configuration")
    views = [_views(tests_of, kept, bench, crew) for tests_of in simulated]
    least = measured.least if measured is not None else _least(views[0], rivals[0])
    fitters = [Fitter(one, Features(one.evidence), least) for one in views]
    if len(fitters) > 1:
        contests = every_contest(rivals, models, fitters, bench.effects, old, lambda: tick("setting rivals against each other"))
    else:
        contests = contests_with_nothing(rivals, fitters[0], bench.effects, lambda: tick("setting effects against nothing"))
    report("choosing", 0.97)
    arena = Arena(contests, fitters[0].least, SIMULATED, repetitions)
    chosen = choose(arena, [trials[k].choice.cost for k in kept], tests)
    proposed = [Proposed(trials[kept[place]], arena.pairs([place])) for place in chosen]
    return Proposal(rivals, proposed, arena.pairs(chosen), len(kept))


def _simulate(
    bench: Bench, trials: Sequence[Trial], model: Candidate, seed: int, crew: Crew
) -> list[list[TestEvidence] | None]:
    """Return the repetitions of every trial with one model as the truth; the draws are alike for all rivals."""

    def one(place: int) -> list[TestEvidence] | None:
        seeds = [seed * 100_000 + place * 10 + number for number in range(SIMULATED)]
        return bench.evidence(trials[place], model, seeds)

    return list(crew.together(one, range(len(trials))))


def _views(tests_of: Sequence[list[TestEvidence] | None], kept: Sequence[int], bench: Bench, crew: Crew) -> Views:
    return Views(Evidence(tuple(test for place in kept for test in tests_of[place] or ())), bench.effects, crew)


def _least(views: Views, truth: Rival) -> Array:
    """Return what a test can gain at most (channels,): half the floor of the simulated repetitions."""
    features = Features(views.evidence)
    return np.maximum(HALF_FLOOR * features.noise_floor(features.of(views.residuals(truth.candidate))), 1e-9)
