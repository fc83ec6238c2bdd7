"""Say what is missing: calibrate, screen, fit, judge against simulated twins, and give one of exactly five verdicts."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hjcamp.analyses.effort import EFFORTS, Effort
from hjcamp.errors import counted
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.bootstrap.early_stopping import FIRST, is_clear, is_far
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import JUDGED, Null, null_of, simulate_twins
from hjcamp.plants.pump_joint.diagnosis.bootstrap.surrogates import match_scatter
from hjcamp.plants.pump_joint.diagnosis.fitting.calibrate import calibrate
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.fitting.pattern_search import settle
from hjcamp.plants.pump_joint.diagnosis.levels import CERTAIN, least_gain, second_gain
from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import rank_drivers, top_drivers
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.repetition import RepetitionScatter, scatter_of
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.screening.detectable import confounded, detectable_amplitudes
from hjcamp.plants.pump_joint.diagnosis.screening.screening import (
    WORTH,
    Screening,
    Step,
    refit_without,
    screen,
    unknowns_of,
)
from hjcamp.plants.pump_joint.diagnosis.selection.step import (
    StepFitter,
    at_most,
    counted_gain,
    rig_chance,
    same_as,
)
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import judge, lacks, law_of, named_by, rivals_of
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
Report = Callable[[str, float], None]


@dataclass
class Diagnosis:
    """The answer and all that stands behind it; ``null`` are twins of the final model.

    ``reference`` is the published model as `scale_of` calibrates it; None where the diagnosis began from another.
    ``screenings`` are those about the baseline and about the final model. ``rig_chance`` is the share of rigs with nothing
    missing and other contacts that gain as much as the first step. ``nulls`` are twins of the model before each step.
    """

    verdict: str
    effects: list[str]
    drivers: list[str]
    p_value: float
    baseline: Fit
    final: Fit
    noise_floor: Array
    null: Null
    steps: list[Step]
    taken: list[Step]
    features: Features
    fitter: Fitter
    scatter: RepetitionScatter
    reason: str
    seconds: float
    detectable: dict[str, tuple[str, float, str]] = field(default_factory=dict)
    confounded: list[dict[str, object]] = field(default_factory=list)
    exploratory: bool = False
    undecided: tuple[str, ...] = ()
    lacking: tuple[str, ...] = ()
    reference: Candidate | None = None
    screenings: Sequence[Screening] = ()
    rig_chance: float = 1.0
    nulls: Sequence[Null] = ()


def diagnose(
    evidence: Evidence,
    effects: Sequence[type[Effect]],
    *,
    effort: str = "standard",
    seed: int = 1,
    start: Candidate | None = None,
    crew: Crew | None = None,
    report: Report = lambda text, share: None,
) -> Diagnosis:
    """Return the diagnosis of the tests in ``evidence`` with the effects of the library.

    ``start`` is a model that has some effects already. ``report(text, share)`` is called with what is being done and
    the share of the work that is done.
    """
    began = time.perf_counter()
    search = _Search(evidence, effects, EFFORTS[effort], seed, crew or Crew(), report)
    return search.run(start, began)


class _Search:
    """The state of one diagnosis."""

    def __init__(
        self, evidence: Evidence, effects: Sequence[type[Effect]], work: Effort, seed: int, crew: Crew, report: Report
    ) -> None:
        self.evidence, self.effects, self.work, self.seed, self.report = evidence, tuple(effects), work, seed, report
        self.crew = crew
        self.features = Features(evidence)
        self.views = Views(evidence, self.effects, crew)
        self.steps: list[Step] = []
        self.nulls: list[Null] = []
        self.twins_of: Fit | None = None
        self.replicates: list[Array] = []
        self.least_gain = partial(least_gain, tests=len(evidence.tests))
        self.second_gain = second_gain(len(evidence.tests))
        self.lacking: tuple[str, ...] = ()

    def run(self, start: Candidate | None, began: float) -> Diagnosis:
        self.report("calibrating the base parameters", 0.02)
        calibrated, self.fitter = calibrate(self.views, self.features, start=start)
        known = unknowns_of(calibrated.candidate, self.effects)
        base = settle(self.fitter, calibrated, known, self.work.sweeps)
        fitting = StepFitter(self.fitter, self.effects, self.work, self.least_gain, self.report)
        # Where no verdict can be given nothing is asked of twins, which take most of the time.
        self.lacking = tuple(lacks(self.evidence))
        screening, null = self._look(base, 0, True)
        first, first_null = screening, null
        current, taken = base, list[Step]()
        for number in range(0 if self.lacking else self.work.forward):
            if number and self.work.hasty and not screening.probes:
                if self._leaves_no_more(base, current, taken, null) and not self._others(taken, current):
                    break
                screening, null = self._look(current, number, True, taken)
            elif number and self._hopeless(screening, base, current, taken, null):
                break
            step, null = self._certain(fitting.step(screening, null, number), null)
            begun = self._begun_anew(step) if step is not None and self._counts(step) else None
            if begun is not None:
                current = begun
                screening, null = self._look(current, number, True, taken)
                if not taken:
                    base, first, first_null = current, screening, null
                step, null = self._certain(fitting.step(screening, null, number), null)
            if step is None:
                break
            self.steps.append(step)
            self.nulls.append(null)
            if not self._counts(step) or self._needless(step, base, current, taken, null):
                break
            current = step.fits[step.best]
            taken.append(step)
            last = number + 1 == self.work.forward
            screening, null = self._look(current, number + 1, not last and not self.work.hasty, taken)
        if not taken and len(null.gains) < self.work.replicates:
            null = first_null = self._null(screening, self.work.replicates)
        kept, taken = self._backward(current, taken, null)
        if kept is not current:
            current = kept
            screening, null = self._look(current, self.work.forward + 1, False)
        self.report("weighing the answer", 0.95)
        noise_floor = np.minimum(self.features.noise_floor(current.features), self.features.noise_floor(base.features))
        found = judge(self.views, self.features, null, base, current, self.steps, taken, self.effects)
        # What no effect explains is looked at without those that did not.
        ranked = top_drivers(rank_drivers(self.features, base, noise_floor))
        drivers = [found.driver, *(one for one in ranked if one != found.driver)] if found.driver else ranked
        rigs = rig_chance(self.steps[0], len(self.evidence.tests)) if self.steps else 1.0
        least = 0.0 if self.lacking else first_null.needed()
        needed = {effect.name: max(least, self.least_gain(effect.name)) for effect in self.effects}
        return Diagnosis(
            found.verdict,
            found.effects,
            drivers if found.verdict == "outside_library" else [],
            max(self.steps[0].p_value, rigs) if self.steps else 1.0,
            base,
            current,
            noise_floor,
            null,
            self.steps,
            taken,
            self.features,
            self.fitter,
            self.scatter,
            found.reason,
            time.perf_counter() - began,
            detectable_amplitudes(first, self.effects, needed),
            confounded(first),
            not self.evidence.repeated,
            found.undecided,
            self.lacking,
            calibrated.candidate if start is None else None,
            (first, screening),
            rigs,
            self.nulls,
        )

    def _look(self, current: Fit, number: int, whole: bool, taken: Sequence[Step] = ()) -> tuple[Screening, Null]:
        """Return the screening about a model (of nothing unless ``whole``) and what it finds in the twins of that model:
        in the first of them where these say enough of it after the steps ``taken``."""
        share = 0.1 + 0.8 * number / (self.work.forward + 1)
        if whole:
            self.report(f"screening {counted(len(self.effects), 'effect')}", share)
        screening = screen(self.fitter, current, self.effects, None if whole else ())
        if current is not self.twins_of:
            self.twins_of, self.replicates, self.number = current, [], number
            self._match(current)
        null = self._few(screening, taken) if self.work.replicates > FIRST and not self.lacking else None
        return screening, null or self._null(screening, self.work.replicates)

    def _few(self, screening: Screening, taken: Sequence[Step]) -> Null | None:
        """Return the first twins of a model where all that is asked of them is clear from these.

        Before anything is taken that is whether an effect gains more than they do; after the first step, where nothing
        promises enough for another, whether the model leaves what they leave.
        """
        if not taken:
            promised = max((screening.gains[name] for name in screening.ranked), default=0.0)
            enough = any(screening.gains[name] >= self.least_gain(name) for name in screening.ranked)
            null = self._null(screening, FIRST) if enough else None
            return null if null is not None and is_clear(promised, null.gains) else None
        if len(taken) > 1 or any(at_most(screening, name) >= self.least_gain(name) for name in screening.ranked):
            return None
        null = self._null(screening, FIRST)
        law = law_of(named_by(taken, self.effects))
        excess = null.excess(taken[0].screening.about.mean_square, screening.about.mean_square, law)
        return null if is_far(excess, null.spread()[:JUDGED]) else None

    def _null(self, screening: Screening, count: int) -> Null:
        """Return what a screening finds in the first ``count`` twins of its model, or in more where there are more."""
        wanted = range(len(self.replicates), min(count, self.work.replicates))
        if wanted and not self.lacking:
            share = 0.1 + 0.8 * self.number / (self.work.forward + 1)
            done = [len(self.replicates)]

            def tick() -> None:
                done[0] += 1
                self.report(f"null replicate {done[0]} of {self.work.replicates}", share + 0.1 * done[0] / self.work.replicates)

            seeds = [self.seed * 100_000 + self.number * 1000 + index for index in wanted]
            self.replicates += simulate_twins(self.fitter, screening.about, self.scatter, seeds, tick)
        return null_of(self.fitter, screening, self.replicates)

    def _match(self, current: Fit) -> None:
        """Match the scatter of twins to that of the tests about a model."""
        self.scatter = scatter_of(self.evidence, dict(current.candidate.base))
        if not self.lacking:
            self.scatter = match_scatter(self.views, current, self.scatter)

    def _certain(self, step: Step | None, null: Null) -> tuple[Step | None, Null]:
        """Return a step and its null with all twins, unless what it gains is as clear in few as its promise was."""
        if step is None or len(null.gains) >= self.work.replicates:
            return step, null
        gain = counted_gain(step)
        if is_clear(gain, null.gains):
            return step, null
        null = self._null(step.screening, self.work.replicates)
        return replace(step, p_value=null.p_value(gain), null_gains=null.gains), null

    def _counts(self, step: Step) -> bool:
        """Whether a step gains more than its twins do, and more than rigs with nothing missing."""
        return step.p_value < CERTAIN and step.gain >= self.least_gain(step.best)

    def _needless(self, step: Step, base: Fit, current: Fit, taken: list[Step], null: Null) -> bool:
        """Whether a further effect gains little or is one of several, where the certain ones leave what their laws may."""
        both = [*taken, step]
        if not taken or rivals_of(taken[0], both, self.steps):
            return False
        if step.gain >= self.second_gain and not rivals_of(step, both, self.steps):
            return False
        return self._leaves_no_more(base, current, taken, null)

    def _hopeless(self, screening: Screening, base: Fit, current: Fit, taken: list[Step], null: Null) -> bool:
        """Whether each further effect would be `_needless` as it is predicted, so that none is fitted."""
        if rivals_of(taken[0], taken, self.steps):
            return False
        promising = any(at_most(screening, name) >= self.second_gain for name in screening.ranked)
        return not promising and self._leaves_no_more(base, current, taken, null)

    def _leaves_no_more(self, base: Fit, current: Fit, taken: list[Step], null: Null) -> bool:
        """Whether the model leaves no more than its own twins and what the laws of its effects may be off by."""
        law = law_of(named_by(taken, self.effects))
        return bool(np.all(null.excess(base.mean_square, current.mean_square, law) <= 1.0))

    def _begun_anew(self, step: Step) -> Fit | None:
        """Return the model without the effect of a step, fitted again from where that has led; None where it is no better.

        Where a fit has not come to its optimum any further effect helps it there, and seems to gain what was left.
        """
        work = self.work
        found = refit_without(self.fitter, step.fits[step.best], step.best, self.effects, work.steps)
        if found.loss > step.screening.about.loss - WORTH:
            return None
        return settle(self.fitter, found, unknowns_of(found.candidate, self.effects), work.sweeps)

    def _others(self, taken: list[Step], current: Fit) -> bool:
        """Whether another effect that gained or promised much beside the model before the last step still promises to after it.

        Beside a certain first effect it has to promise what `_needless` will ask of it.
        """
        step = taken[-1]
        enough = 0.0 if rivals_of(taken[0], taken) else self.second_gain
        own = (step.best, *same_as(self.effects, step.best))
        # what is shown as it is predicted may gain less at its start than it promises
        gained = {name: step.gain_of(name) for name in step.fits}
        others = [
            name
            for name, promised in step.screening.gains.items()
            if max(promised, gained.get(name, promised)) > self.least_gain(name) and name not in own
        ]
        if not others:
            return False
        screening = screen(self.fitter, current, self.effects, others)
        return any(at_most(screening, name) > max(enough, self.least_gain(name)) for name in others)

    def _backward(self, current: Fit, taken: list[Step], null: Null) -> tuple[Fit, list[Step]]:
        """Leave out again what is not needed any more once further effects are in the model."""
        for step in taken[:-1]:
            without = refit_without(self.fitter, current, step.best, self.effects, self.work.steps)
            without = settle(self.fitter, without, unknowns_of(without.candidate, self.effects), self.work.sweeps)
            if without.loss - current.loss < max(self.least_gain(step.best), null.needed()):
                current, taken = without, [other for other in taken if other is not step]
        return current, taken
