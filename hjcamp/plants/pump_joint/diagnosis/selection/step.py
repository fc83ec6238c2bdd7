"""One step forward of a diagnosis: fit the effects of a screening that may still turn out best, and weigh them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from hjcamp.analyses.effort import Effort
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.fitting.pattern_search import settle
from hjcamp.plants.pump_joint.diagnosis.levels import CERTAIN, chance
from hjcamp.plants.pump_joint.diagnosis.screening.detectable import similar
from hjcamp.plants.pump_joint.diagnosis.screening.responses import work_of
from hjcamp.plants.pump_joint.diagnosis.screening.screening import (
    WORTH,
    Screening,
    Step,
    best_start,
    fit_from,
    rival_weights,
    starts_of,
    unknowns_of,
)

SAME = 0.95
PAIR = 2
# So far behind the best fit, slips alone may have held a fit back.
BEHIND = 30.0


@dataclass
class StepFitter:
    """Fits one more effect beside a model; ``least_gain(name)`` is what counts, ``report(text, share)`` hears of each fit."""

    fitter: Fitter
    effects: Sequence[type[Effect]]
    work: Effort
    least_gain: Callable[[str], float]
    report: Callable[[str, float], None]

    def step(self, screening: Screening, null: Null, number: int) -> Step | None:
        """Return the fits of the most promising effects and of those that look the same as the best of them."""
        ranked = [name for name in sorted(screening.gains, key=lambda name: -screening.gains[name]) if name in screening.ranked]
        # The first step shows what comes nearest, where none of it can count as it is predicted.
        asked = {name: self.least_gain(name) for name in ranked}
        enough = {name: max(null.needed(), least if number or self.work.hasty else 0.0) for name, least in asked.items()}
        if not ranked or (number and not any(at_most(screening, name) >= enough[name] for name in ranked)):
            return None
        if not any(at_most(screening, name) >= least for name, least in asked.items()):
            return self._hopeless(screening, null, ranked[:PAIR])
        share = 0.25 + 0.8 * number / (self.work.forward + 1)
        fits = self._survivors(screening, ranked[: self.work.survivors], share, enough)
        best = min(fits, key=lambda name: fits[name].loss)
        rivals = dict.fromkeys([*similar(screening, best, SAME), *same_as(self.effects, best)])
        self._fit(screening, [name for name in rivals if name in screening.ranked and name not in fits], fits, share + 0.1)
        self._settle(screening, fits)
        best = min(fits, key=lambda name: fits[name].loss)
        here = unknowns_of(fits[best].candidate, self.effects)
        polished = self.fitter.fit(fits[best].candidate, here, steps=2 * self.work.steps, enough=0.05)
        fits[best] = min(fits[best], polished, key=lambda fit: fit.loss)
        fits |= self._predicted(screening, [name for name in ranked if name not in fits][: max(PAIR - len(fits), 0)])
        weights = rival_weights(fits, self.fitter.least, self.effects)
        best = max(weights, key=lambda name: weights[name])
        found = Step(screening, fits, weights, 1.0, null.gains)
        return replace(found, p_value=null.p_value(counted_gain(found)))

    def _hopeless(self, screening: Screening, null: Null, names: list[str]) -> Step:
        """Return a step of effects that cannot gain enough, as they are predicted, without fits."""
        fits = self._predicted(screening, names)
        weights = rival_weights(fits, self.fitter.least, self.effects)
        return Step(screening, fits, weights, max(null.p_value(max(screening.gains.values())), CERTAIN), null.gains)

    def _predicted(self, screening: Screening, names: Sequence[str]) -> dict[str, Fit]:
        """Return effects as they are predicted, not fitted: what a table shows behind one that is far ahead of them."""
        return {name: best_start(self.fitter, screening, self._library[name]) for name in names}

    def _settle(self, screening: Screening, fits: dict[str, Fit]) -> None:
        """Settle the fits that may still turn out best: near the best one, and with a prediction that matters."""
        if self.work.sweeps < 1:
            return
        near = min(fit.loss for fit in fits.values()) + BEHIND
        names = [name for name, fit in fits.items() if fit.loss < near and at_most(screening, name) > self.least_gain(name)]
        context = (self.fitter, [fits[name] for name in names], self.effects, self.work.sweeps)
        for name, fit in zip(names, self.fitter.crew.each(_settle_one, context, range(len(names))), strict=True):
            fits[name] = fit

    def _survivors(self, screening: Screening, names: list[str], share: float, enough: Mapping[str, float]) -> dict[str, Fit]:
        """Return the fits of the most promising effects, without those that no gain can be hoped of.

        More than twice the prediction does not count (`at_most`), so that what cannot reach ``enough`` is never taken, and
        what is behind the gain of another is not its rival. At most two go together, however many workers there are: the
        answer must not depend on them.
        """
        fits: dict[str, Fit] = {}
        waiting = list(names)
        while waiting:
            gain = max((screening.about.loss - fit.loss for fit in fits.values()), default=screening.gains[waiting[0]])
            hoped = [name for name in waiting if at_most(screening, name) >= max(gain - WORTH, enough[name])][:PAIR]
            if fits and not hoped:
                break
            together = hoped or waiting[:PAIR]
            self._fit(screening, together, fits, share)
            waiting = [name for name in waiting if name not in together]
        return fits

    def _fit(self, screening: Screening, names: list[str], fits: dict[str, Fit], share: float) -> None:
        context = (self.fitter, screening, self.effects, self.work.steps)
        longest_first = sorted(names, key=lambda name: -work_of(self._library[name]))
        jobs = [(name, ranks) for name in longest_first for ranks in starts_of(screening, self._library[name])]
        found: dict[str, Fit] = {}
        for (name, _), fit in zip(jobs, self.fitter.crew.each(_fit_one, context, jobs), strict=True):
            found[name] = min(found.get(name, fit), fit, key=lambda one: one.loss)
            self.report(f"fitted {name}", share + 0.1 * len(found) / (len(names) + len(found)))
        fits.update({name: found[name] for name in names})

    @cached_property
    def _library(self) -> dict[str, type[Effect]]:
        return {effect.name: effect for effect in self.effects}


def same_as(effects: Sequence[type[Effect]], name: str) -> list[str]:
    """Return the effects that say they can be the same thing."""
    said = [other for effect in effects if effect.name == name for other in effect.same_as]
    return [*said, *(effect.name for effect in effects if name in effect.same_as)]


def at_most(screening: Screening, name: str) -> float:
    """Return what a fit may gain: far more than its own linear prediction follows noise that the twins do not see."""
    return 2.0 * screening.gains[name] + 1.0


def counted_gain(step: Step) -> float:
    """Return the gain of a step's best effect as far as it counts."""
    return min(step.gain, at_most(step.screening, step.best))


def rig_chance(step: Step, tests: int) -> float:
    """Return the share of rigs with nothing missing and other contacts that gain as unusually much in so many tests."""
    return chance(step.best, counted_gain(step), tests)


def _settle_one(context: tuple[Fitter, list[Fit], tuple[type[Effect], ...], int], index: int) -> Fit:
    fitter, fits, effects, sweeps = context
    return settle(fitter, fits[index], unknowns_of(fits[index].candidate, effects), sweeps)


def _fit_one(context: tuple[Fitter, Screening, tuple[type[Effect], ...], int], job: tuple[str, tuple[int, ...]]) -> Fit:
    fitter, screening, effects, steps = context
    name, ranks = job
    effect = next(effect for effect in effects if effect.name == name)
    return fit_from(fitter, screening, effect, effects, steps, ranks)
