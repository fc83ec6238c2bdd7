"""Forward selection of what a model misses: named effects and unknowns compete, step by step, until nothing matters."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.base_values import DELAY
from hjcamp.model.candidate import Candidate
from hjcamp.model.effect import Effect
from hjcamp.prediction.chance import chance_gains, moved_orders, p_value
from hjcamp.prediction.chapters import advantages, critical, left_out, ratio_t, told_apart
from hjcamp.prediction.fitting import TURNS, TURNS_OF_BASE, Fitted, Free, fit, settled
from hjcamp.prediction.floor import motion_of
from hjcamp.prediction.laws import alike_laws, kind_of, law_of
from hjcamp.prediction.levels import (
    FITTED,
    FITTED_BY_CHANCE,
    FITTED_STARTS,
    FITTED_UNKNOWNS,
    LEVEL,
    MATTERS,
    SCATTER,
    STEPS,
    TRIED_ROUNDS,
    TRIED_STARTS,
)
from hjcamp.prediction.likelihood import loss, size
from hjcamp.prediction.regression import regression_of
from hjcamp.prediction.scored import Follows, Scored, Step
from hjcamp.prediction.screening import (
    Beside,
    Probe,
    Projection,
    Promise,
    best_promises,
    free_of_effect,
    free_of_unknown,
    probes_of,
    probes_of_unknown,
    refined,
)
from hjcamp.prediction.unknowns import Unknown
from hjcamp.prediction.visited import Range, visited_shapes
from hjcamp.prediction.windows import Windows

Array = NDArray[np.float64]
Report = Callable[[str, float], None]
Given = TypeVar("Given")
Found = TypeVar("Found")


@dataclass
class Search:
    """What a search needs: the windows, the effects that may be missing, the unknowns, the chapters, the base's parameters.

    ``unnamed`` are effects of the library that a base may have (the forms of contacts), but that are not looked for; ``needed`` are
    effects that were found beside a free law, ``wanted`` those that are looked at closely whatever they promise;
    ``declared`` are the base's parameters before they were fitted.
    """

    windows: Windows
    library: Mapping[str, type[Effect]]
    unknowns: Mapping[str, Unknown]
    chapters: NDArray[np.int64]
    base_free: Sequence[Free]
    ranges: Mapping[str, Range]
    seed: int = 1
    report: Report = lambda text, share: None
    workers: int = 1
    begins: dict[str, dict[str, float]] = field(default_factory=dict)
    claims: float = LEVEL
    unnamed: frozenset[str] = frozenset()
    needed: frozenset[str] = frozenset()
    wanted: frozenset[str] = frozenset()
    declared: Mapping[str, float] = field(default_factory=dict)
    steps: list[Step] = field(default_factory=list)
    _beside: tuple[Fitted, Beside] | None = None

    def scored(self, fitted: Fitted, windows: Windows | None = None) -> Scored:
        """Return a fit with what it leaves of chapters that it does not know, over windows that begin where it has them."""
        names, windows = tuple(fitted.candidate.effects), windows or self.windows
        if not np.isfinite(fitted.loss):
            return Scored(names, fitted, fitted.features, math.inf, windows.place)
        features = left_out(windows, fitted, self.chapters)
        return Scored(names, fitted, features, size(features), windows.place)

    def each(
        self, work: Callable[[Given], Found], given: Sequence[Given], words: Callable[[Given], str]
    ) -> list[Found]:
        """Return what ``work`` makes of each of ``given``, in order, by ``workers`` threads: a kernel leaves the interpreter free."""
        found: list[Found] = []
        with ThreadPoolExecutor(self.workers) as pool:
            try:
                for one, made in zip(given, pool.map(work, given), strict=True):
                    found.append(made)
                    self.report(words(one), len(found) / len(given))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return found

    def free_of(self, candidate: Candidate) -> list[Free]:
        """Return all free parameters of a candidate: of the form of a contact that could be an effect how far it gives way, no more."""
        found = list(self.base_free)
        for name in candidate.effects:
            if name in self.unknowns:
                found += free_of_unknown(self.unknowns[name])
                continue
            effect = self.library[name]
            whole = name not in self.windows.forms or not effect.claimed
            found += [one for one in free_of_effect(effect) if whole or one.name == effect.granted]
        return found

    def fitted(self, start: Candidate, near: Fitted | None = None) -> Scored:
        """Return the fit of a model from ``start``; ``near`` lends it slopes to begin with.

        Each model has starts of its own: those of another one favour that.
        """
        own = copy.copy(self.windows)
        return self.scored(self.settled(start, near, own), own)

    def settled(self, start: Candidate, near: Fitted | None = None, windows: Windows | None = None) -> Fitted:
        """Return the fit of a model from ``start`` with the starts of ``windows``, or those of a copy, moved along."""
        return settled(windows or copy.copy(self.windows), start, self.free_of(start), near, self.turns)

    @property
    def turns(self) -> int:
        """How often a fit and the windows' starts follow one another: of short tests until they agree."""
        return TURNS_OF_BASE if self.windows.layout.short else TURNS

    def look(self, before: Scored) -> Step:
        """Return what a model may miss: screen everything, then fit what promises most."""
        fitted, self.windows.place = before.fitted, before.place
        self.windows.kernels.hold(fitted.candidate.effects)
        projection, _ = Projection(fitted), self.beside(fitted)
        names = [name for name in (*self.library, *self.unknowns) if self.may_be_added(name, fitted.candidate.effects)]
        found = self.each(
            lambda name: self.probes(fitted, name), names, lambda name: f"screening {name.replace('_', ' ')}"
        )
        probes = [probe for one in found for probe in one]
        layout = self.windows.layout
        orders = moved_orders(layout.of_test, motion_of(layout, layout.readings), self.seed + len(self.steps))
        promised = chance_gains(projection, probes, orders, self.seed + len(self.steps))
        gain, chance = promised.gain, promised.shifted
        effects = {**self.library, **{name: one.effect for name, one in self.unknowns.items()}}
        promises = [projection.promise(probe, effects[probe.effect]) for probe in probes]
        best = best_promises(promises)
        usual = float(np.median(chance)) if len(chance) else 0.0
        chosen = FITTED if p_value(gain, chance) <= LEVEL else FITTED_BY_CHANCE
        sure = [name for name in names if name in {*self.begins, *self.wanted} or self.hidden_by_base(name, fitted.candidate)]
        able = [name for name, one in best.items() if name in self.library and one.gain > 0.0 and name not in sure]
        able = [name for k, name in enumerate(able[: 2 * chosen]) if k < chosen // 2 or best[name].gain > usual]
        begun = self.each(
            lambda name: self.begun(projection, name, [one for one in promises if one.effect == name]), [*sure, *able],
            lambda name: f"looking closer at {name}",
        )  # fmt: skip
        begun.sort(key=lambda one: one.loss)
        # what is promised is linear; what a curved law gains is seen when it is fitted
        gain = max([gain, *(fitted.loss - one.loss for one in begun[:1] if np.isfinite(one.loss))])
        chosen, unnamed = (FITTED, FITTED_UNKNOWNS) if p_value(gain, chance) <= LEVEL else (FITTED_BY_CHANCE, 0)
        others = [one for name, one in best.items() if name in self.unknowns][:unnamed]
        starts = [*begun[:chosen], *(self.begun_unknown(fitted, one) for one in others)]
        # what gains no more than chance promises cannot be claimed; two are fitted to be shown
        starts = [one for one in starts if fitted.loss - one.loss > usual or one in begun[:FITTED_BY_CHANCE]]
        models = self.each(
            lambda start: self.fitted(start.candidate, start), starts,
            lambda start: f"fitting {_added(start.candidate, fitted.candidate)}",
        )  # fmt: skip
        models = sorted((one for one in models if np.isfinite(one.left_out)), key=lambda one: one.left_out)
        added = [_added(one.fitted.candidate, fitted.candidate) for one in models]
        named = tuple(one for one, name in zip(models, added, strict=True) if name in self.library)
        others_fitted = tuple(one for one, name in zip(models, added, strict=True) if name in self.unknowns)
        different = len({order.tobytes() for order in orders})
        step = Step(
            before, p_value(gain, chance), chance, gain, named, others_fitted, self.claims, different, promised.decoys, promised.twins
        )
        self.steps.append(step)
        return step

    def may_be_added(self, name: str, present: Iterable[str]) -> bool:
        """Whether an effect is looked for and not there yet, and no other one that says the same of the same driver.

        Two laws of one driver in one place are one law of another form: the second would only mend the first.
        """
        law = law_of(self.library[name]) if name in self.library else None
        return name not in (*present, *self.unnamed) and not any(
            law and law == law_of(self.library[one]) for one in present if one in self.library
        )

    def hidden_by_base(self, name: str, candidate: Candidate) -> bool:
        """Whether the base has something in the place of an effect, beside which little of it is promised.

        Of a lag that is the delay of an input; of what depends on a state that nothing measures the starts of that state.
        """
        effect = self.library.get(name)
        if effect is None:
            return False
        states = [*self.windows.layout.measured.plant.states]
        unseen = {one for one, hidden in zip(states, self.windows.unseen, strict=True) if hidden}
        if any(unseen & set(term.arguments) for term in effect.terms.values()):
            return True
        late = any(value > 0.0 for key, value in candidate.base.items() if key.startswith(DELAY))
        return late and bool(effect.states) and kind_of(effect) in ("actuator", "sensor")

    def beside(self, fitted: Fitted) -> Beside:
        """Return the model beside which effects are probed, made once for each fit."""
        if self._beside is None or self._beside[0] is not fitted:
            self._beside = (fitted, Beside.of(self.windows, fitted))
        return self._beside[1]

    def probes(self, fitted: Fitted, name: str) -> list[Probe]:
        """Return the probes of a named effect or an unknown beside a fitted model."""
        beside = self.beside(fitted)
        if name in self.unknowns:
            return list(probes_of_unknown(self.windows, beside, self.unknowns[name]))
        return list(probes_of(self.windows, beside, self.library[name], self.visited(name)))

    def visited(self, name: str) -> dict[str, Range]:
        """Return what the tests visit of the shapes of an effect."""
        return visited_shapes(self.library[name], self.windows.layout.measured.plant, self.ranges)

    def begun(self, projection: Projection, name: str, promises: Sequence[Promise]) -> Fitted:
        """Return the best fit after few rounds: from where a named effect promises most, and from its usual values.

        What is promised is linear: the best start of a curved law need not be the one that promises most.
        """
        before, effect = projection.fitted, self.library[name]
        most = sorted((one for one in promises if one.gain > 0.0), key=lambda one: -one.gain)[:TRIED_STARTS]
        own = [dict(effect.defaults()), *([self.begins[name]] if name in self.begins else [])]
        if most:
            most.append(refined(self.windows, self.beside(before), projection, effect, most[0], self.visited(name)))
            own.append(dict(most[0].candidate.effects[name]))
        starts = [one.candidate for one in most] + [before.candidate.with_effect(name, one) for one in own]
        if self.windows.layout.short:
            # the base may have taken the place of the effect
            starts += [before.candidate.with_base(self.declared).with_effect(name, one) for one in own]
        return self.best_of(starts, before)

    def begun_unknown(self, before: Fitted, promise: Promise) -> Fitted:
        """Return the better of two starts of an unknown: what is promised, and nothing."""
        name, knots = promise.effect, self.unknowns[promise.effect].amplitudes
        zero = {**promise.candidate.effects[name], **dict.fromkeys(knots, 0.0)}
        return self.best_of([promise.candidate, before.candidate.with_effect(name, zero)], before)

    def best_of(self, starts: Sequence[Candidate], before: Fitted) -> Fitted:
        """Return the best fit after few rounds from those starts that are best as they are, and from the plain one of the best.

        Of short tests all are fitted to the end: what is best as it is often leads nowhere, and it takes little.
        """
        if self.windows.layout.short:
            best = min((self.settled(one) for one in starts), key=lambda one: one.loss)
            return min(best, self.settled(self.plain(best.candidate, before.candidate)), key=lambda one: one.loss)
        starts = sorted(starts, key=lambda one: loss(self.windows.features(one)))[:FITTED_STARTS]
        starts += [one for one in [self.plain(starts[0], before.candidate)] if one.key != starts[0].key]
        tried = [fit(self.windows, one, self.free_of(one), TRIED_ROUNDS, before, exact=False) for one in starts]
        return min(tried, key=lambda one: one.loss)

    def matters(self, model: Scored, before: Scored, level: float = LEVEL) -> bool:
        """Whether a model takes a share of the error that matters, and does so chapter by chapter."""
        if not self.beats(model, before, level) or self.error_ratio(model, before) > 1.0 - MATTERS:
            return False
        return not self.only_scatter(model, before)

    def only_scatter(self, model: Scored, before: Scored) -> bool:
        """Whether friction differs with place or time by no more than every contact's does: that is how friction is, no effect."""
        laws = [self.unknowns.get(name) or self.library[name] for name in model.beyond(before)]
        if not laws or not all(one.scatters for one in laws):
            return False
        kept, self.windows.place = self.windows.place, before.place
        usual = self.windows.features(before.fitted.candidate)
        found = self.windows.features(model.fitted.candidate)
        self.windows.place = kept
        return bool(np.linalg.norm(found - usual) <= np.linalg.norm(self.scatter(before)))

    def scatter(self, model: Scored) -> Array:
        """Return what friction that differs as much as every contact's does changes (windows, d)."""
        kept, self.windows.place = self.windows.place, model.place
        usual = self.windows.features(model.fitted.candidate)
        most = self.windows.features(model.fitted.candidate, friction=1.0 + SCATTER)
        self.windows.place = kept
        return np.asarray(most - usual)

    def error_ratio(self, model: Scored, before: Scored) -> float:
        """Return what a model leaves of another's rms on chapters left out, in the sensor in which it takes most."""
        return self.rms_ratio(model.features, before.features)

    def rms_ratio(self, one: Array, other: Array) -> float:
        """Return the rms of features (windows, d) over that of others, in the sensor in which it is least."""
        sensors = len(self.windows.layout.measured.sensors)
        left, whole = (np.mean(f**2, axis=0).reshape(sensors, -1).mean(axis=1) + 1.0 for f in (one, other))
        return math.sqrt(float(np.min(left / whole)))

    def follows_motion(self, model: Scored) -> Follows:
        """Return how much of what a model leaves follows from the motion, by whatever law; nothing where none is shown to.

        It is shown where a regression predicts chapters left out better at the level of all claims, by a share that matters,
        and by more than friction that differs as every contact's does: on the motion as it was measured and as it is predicted.
        Readings have the noise that is left of a model, predictions that of their starts; what both tell is no noise.
        """
        measured = self._follows(model, self.windows.layout.readings)
        if not measured.share:
            return measured
        return min(measured, self._follows(model, self.predicted(model)), key=lambda one: one.share)

    def _follows(self, model: Scored, readings: Array) -> Follows:
        """Return how much of what a model leaves follows from the motion that readings (n, sensors) describe."""
        found = regression_of(self.windows.layout, model.features, self.chapters, readings)
        before, chapters = model.features[found.rows], self.chapters[found.rows]
        apart = told_apart(found.features, before, chapters)
        t, count = ratio_t(advantages(found.features, before, chapters), apart)
        left, nothing = self.rms_ratio(found.features, before), Follows(0.0, 0.0)
        if t <= critical(count, self.claims) or left > 1.0 - MATTERS:
            return nothing
        if np.linalg.norm(before - found.features) <= np.linalg.norm(self.scatter(model)[found.rows]):
            return nothing
        return Follows(1.0 - left, max(math.log(size(before) / size(found.features)), 0.0))

    def predicted(self, model: Scored) -> Array:
        """Return what a model predicts of all readings (n, sensors), from its own starts."""
        kept, self.windows.place = self.windows.place, model.place
        found = self.windows.readings(model.fitted.candidate)[0]
        self.windows.place = kept
        return np.where(np.isfinite(found), found, self.windows.layout.readings)

    def beats(self, model: Scored, other: Scored, level: float = LEVEL) -> bool:
        """Whether a model is better on chapters that it does not know, at a level."""
        if not math.isfinite(model.left_out) or not math.isfinite(other.left_out):
            return math.isfinite(model.left_out)
        t, chapters = self.t(model, other)
        return t > critical(chapters, level)

    def t(self, model: Scored, other: Scored) -> tuple[float, float]:
        """Return Student's t of a model's advantage over another, and the number of chapters that it stands on."""
        found = advantages(model.features, other.features, self.chapters)
        return ratio_t(found, told_apart(model.fitted.features, other.fitted.features, self.chapters))

    def resettled(self, model: Scored) -> Scored:
        """Return a model with the windows' starts moved to where it fits best, if that is better, and leave them there."""
        self.windows.place = model.place
        found = self.scored(self.settled(model.fitted.candidate, model.fitted, self.windows))
        best = min(found, model, key=lambda one: one.left_out)
        self.windows.place = best.place
        return best

    def plain(self, candidate: Candidate, before: Candidate) -> Candidate:
        """Return a candidate without the forms of contacts that were there before, and without delays of inputs.

        A base takes them in place of what is missing, and a fit that begins with them may never get rid of them.
        """
        delays = [one.name for one in self.base_free if one.name.startswith(DELAY)]
        return candidate.without(self.windows.forms & set(before.effects)).with_base(dict.fromkeys(delays, 0.0))

    def run(self, base: Scored) -> Scored:
        """Return the model with all named effects that matter, one added at a time; ``steps`` tells each look."""
        model = base
        for _ in range(STEPS):
            step = self.look(model)
            if step.p_value > self.claims or not step.named:
                break
            # the one that leaves least need not be one that is shown chapter by chapter
            shown = (one for one in step.named if self.matters(one, model, step.level))
            best = next(shown, None) or self.better_than_free_laws(model, step)
            alone = best is not None
            best = best or self.beside_free_law(model, step)
            if best is None or self.mends(best, model, step):
                self.windows.place = model.place
                break
            if not alone:
                self.needed |= set(best.beyond(model))
            model = self.thinned(self.resettled(best))
        return model

    def mends(self, further: Scored, model: Scored, step: Step) -> bool:
        """Whether a further name takes no more than a free law over what drives a name that is there.

        Then the law of that one is off in form, which the answer says, and is no second thing that is missing.
        """
        there = [self.library[name] for name in model.names if name in self.library and name not in self.windows.forms]
        for one in step.unknown:
            free = self.unknowns[_added(one.fitted.candidate, model.fitted.candidate)]
            other_form = one.left_out <= further.left_out and any(alike_laws(free, name) for name in there)
            if other_form and self.matters(one, model, step.level_of_unknown):
                return True
        return False

    def better_than_free_laws(self, before: Scored, step: Step) -> Scored | None:
        """Return the effect that leaves less than every free law of the step, where one of these is shown to take what matters.

        That something is missing the free law shows; it is no better news than a name that leaves less.
        """
        shown = [one.left_out for one in step.unknown if self.matters(one, before, step.level_of_unknown)]
        able = (one for one in step.named if shown and one.left_out <= min(shown))
        return next(
            (one for one in able if self.error_ratio(one, before) <= 1.0 - MATTERS and not self.only_scatter(one, before)), None
        )

    def beside_free_law(self, before: Scored, step: Step) -> Scored | None:
        """Return a model of the step with an effect that matters beside a free law, which matters beside it, and both more than none.

        Where two things are missing, each alone leaves so much that it hardly stands out chapter by chapter.
        """
        found = [one for one in step.named if self.error_ratio(one, before) <= 1.0 - MATTERS]
        level = self.claims / max(FITTED_UNKNOWNS * len(found), 1)
        for one in found:
            self.windows.place = one.place
            self.windows.kernels.hold(one.fitted.candidate.effects)
            projection = Projection(one.fitted)
            probes = [probe for name in self.unknowns for probe in self.probes(one.fitted, name)]
            promises = best_promises([projection.promise(probe, self.unknowns[probe.effect].effect) for probe in probes])
            for promise in list(promises.values())[:FITTED_UNKNOWNS]:
                begun = self.begun_unknown(one.fitted, promise)
                both = self.fitted(begun.candidate, begun)
                if not self.matters(both, one, level) or not self.matters(both, before, level):
                    continue
                alone = self.fitted(both.fitted.candidate.without(one.beyond(before)), both.fitted)
                if self.matters(both, alone, level):
                    return one
        self.windows.place = before.place
        return None

    def thinned(self, model: Scored) -> Scored:
        """Return the model without effects that it can do without (backward elimination)."""
        while len(names := [name for name in model.names if name not in self.windows.forms | self.needed]) > 1:
            less = [self.fitted(model.fitted.candidate.without([name])) for name in names]
            best = min(less, key=lambda one: one.left_out)
            if self.matters(model, best):
                break
            model, self.windows.place = best, best.place
        return model


def _added(candidate: Candidate, before: Candidate) -> str:
    [name] = set(candidate.effects) - set(before.effects)
    return name
