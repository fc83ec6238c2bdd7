"""Forward selection of what a model misses: named effects and unknowns compete, step by step, until nothing matters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from hjcamp.diagnosis.candidates.equivalence import equivalent_laws, is_lag, is_of_its_own, law_of
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown, courses_of_each, values_of
from hjcamp.diagnosis.data.repeatability import motion_of
from hjcamp.diagnosis.levels import FITTED, FITTED_BY_CHANCE, FITTED_UNKNOWNS, LEVEL, MATTERS, MOST_OF_IT, STEPS
from hjcamp.diagnosis.screening.chance import chance_gains, moved_orders, p_value
from hjcamp.diagnosis.screening.screening import Projection, Promise, best_promises
from hjcamp.diagnosis.selection.claims import Claims
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.model.declare.candidate import Candidate


@dataclass
class Search(Claims):
    """A search for what is missing; ``steps`` tells each look.

    ``unnamed`` are effects of the library that a base may have (the forms of contacts), but that are not looked for; ``needed`` are
    effects that were found beside a free law, ``with_law`` the last of these with that law, ``wanted`` those that are looked at
    closely whatever they promise.
    """

    unnamed: frozenset[str] = frozenset()
    needed: frozenset[str] = frozenset()
    with_law: Scored | None = None
    wanted: frozenset[str] = frozenset()
    steps: list[Step] = field(default_factory=list)

    def look(self, before: Scored, among: Iterable[str] = ()) -> Step:
        """Return what a model may miss: screen everything, or what is ``among`` these alone, then fit what promises most."""
        fitted, self.windows.place = before.fitted, before.place
        self.windows.kernels.hold(fitted.candidate.effects)
        projection, _ = Projection(fitted), self.probed_model(fitted)
        looked_for = tuple(among) or (*self.library, *self.unknowns)
        names = [name for name in looked_for if self.may_be_added(name, fitted.candidate.effects)]
        self.windows.kernels.prepare(names)
        found = self.each(lambda name: self.probes(fitted, name), names, lambda name: f"screening {name.replace('_', ' ')}")
        probes = [probe for one in found for probe in one]
        layout = self.windows.layout
        orders = moved_orders(layout.of_test, motion_of(layout, layout.readings), self.seed + len(self.steps))
        promised = chance_gains(projection, probes, orders, self.seed + len(self.steps))
        gain, chance, usual = promised.gain, promised.shifted, promised.usual
        effects = {**self.library, **{name: one.effect for name, one in self.unknowns.items()}}
        promises = [projection.promise(probe, effects[probe.effect]) for probe in probes]
        best = best_promises(promises)
        chosen = FITTED if p_value(gain, chance) <= LEVEL else FITTED_BY_CHANCE
        sure = [name for name in names if name in {*self.begins, *self.wanted} or self.hidden_by_base(name, fitted.candidate)]
        able = [name for name, one in best.items() if name in self.library and one.gain > 0.0 and name not in sure]
        able = [name for k, name in enumerate(able[: 2 * chosen]) if k < chosen // 2 or best[name].gain > usual]
        begun = self.each(
            lambda name: self.begun(projection, name, [one for one in promises if one.effect == name]),
            [*sure, *able],
            lambda name: f"looking closer at {name}",
        )
        begun.sort(key=lambda one: one.loss)
        # what is promised is linear; what a curved law gains is seen when it is fitted
        closer = [one for one in begun[:1] if np.isfinite(one.loss)]
        gain = max(
            [gain, *(promised.stands_out(_added(one.candidate, fitted.candidate), fitted.loss - one.loss) for one in closer)]
        )
        chosen, unnamed = (FITTED, FITTED_UNKNOWNS) if p_value(gain, chance) <= LEVEL else (FITTED_BY_CHANCE, 0)
        others = [one for name, one in best.items() if name in self.unknowns][:unnamed]
        starts = [*begun[:chosen], *(self.begun_unknown(fitted, one) for one in others)]
        # what gains no more than chance promises cannot be claimed; two are fitted to be shown
        starts = [one for one in starts if fitted.loss - one.loss > usual or one in begun[:FITTED_BY_CHANCE]]
        models = self.each(
            lambda start: self.fitted(start.candidate, start),
            starts,
            lambda start: f"fitting {_added(start.candidate, fitted.candidate)}",
        )
        models = sorted((one for one in models if np.isfinite(one.left_out)), key=lambda one: one.left_out)
        added = [_added(one.fitted.candidate, fitted.candidate) for one in models]
        named = tuple(one for one, name in zip(models, added, strict=True) if name in self.library)
        others_fitted = tuple(one for one, name in zip(models, added, strict=True) if name in self.unknowns)
        different = len({order.tobytes() for order in orders})
        step = Step(
            before,
            p_value(gain, chance),
            chance,
            gain,
            named,
            others_fitted,
            self.claims,
            different,
            promised.decoys,
            promised.replicates,
        )
        self.steps.append(step)
        return step

    def look_at_values(self, before: Scored) -> Step:
        """Return what a model may miss where some parameter is no constant: each over every state and input, and over time."""
        laws = self.values(before)
        self.admit(laws)
        return self.look(before, laws)

    def courses(self, before: Scored) -> list[Scored]:
        """Return the fits of the laws over time that promise most beside a model, whatever chance promises."""
        laws = [name for name, one in self.unknowns.items() if one.driver == "time"]
        begun = [self.begun_unknown(before.fitted, one) for one in self.promised_beside(before, laws)[:FITTED_UNKNOWNS]]
        return self.each(lambda one: self.fitted(one.candidate, one), begun, lambda one: "fitting what drifts")

    def values(self, before: Scored | None = None) -> dict[str, Unknown]:
        """Return the laws of the base's parameters that are no constants, and `drifts`; no model has them before they are admitted.

        Of a parameter that stands at its bound in a model there is none: its law would go on where that may not.
        """
        plant = self.windows.layout.measured.plant
        names = [one.name for one in self.base_free if before is None or not one.bounded(before.fitted.candidate)]
        return values_of(plant, names, self.ranges) | self.drifts()

    def drifts(self) -> dict[str, Unknown]:
        """Return the laws over time with a course of its own in each condition, by name.

        A course has half as many pieces as its condition has blocks: of fewer than two no block tells of another one.
        """
        layout = self.windows.layout
        conditions = len(layout.measured.conditions)
        pieces = len(np.unique(self.blocks)) // conditions // 2
        if conditions < 2 or pieces < 2:
            return {}
        return courses_of_each(layout.measured.plant, conditions, pieces + 1, float(layout.time.max()), self.ranges)

    def admit(self, laws: Mapping[str, Unknown]) -> None:
        """Let further unknowns be part of models."""
        self.windows.kernels.add({name: one.effect for name, one in laws.items() if name not in self.unknowns})
        self.unknowns = {**self.unknowns, **laws}

    def may_be_added(self, name: str, present: Iterable[str]) -> bool:
        """Whether an effect is looked for and not there yet, and no other one that says the same of the same driver.

        Two laws of one driver in one place are one law of another form: the second would only mend the first. What acts behind all
        others in a slot is looked for where one of them bends it.
        """
        law = law_of(self.library[name]) if name in self.library else None
        named = [self.library[one] for one in present if one in self.library]
        return (
            name not in (*present, *self.unnamed)
            and not any(law and law == law_of(one) for one in named)
            and (name not in self.library or is_of_its_own(self.library[name], named))
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
        return self.late_base(name, candidate)

    def run(self, base: Scored) -> Scored:
        """Return the model with all named effects that matter, one added at a time; ``steps`` tells each look."""
        model, added = base, base.beyond(base)
        for _ in range(STEPS):
            step = self.look(model)
            model, step = self.by_another_lag(model, added, step)
            if step.p_value > self.claims or not step.named:
                break
            # the one that leaves least need not be one that is shown block by block
            shown = (one for one in step.named if self.matters(one, model, step.level))
            best = next(shown, None)
            best = self.beside_another(best, model, step) or best or self.better_than_free_laws(model, step)
            alone = best is not None
            best = best or self.beside_free_law(model, step)
            if best is None or self.mends(best, model, step):
                self.windows.place = model.place
                break
            if not alone:
                self.needed |= set(best.beyond(model))
            added = best.beyond(model)
            model = self.thinned(self.exchanged(self.resettled(best), base))
        return model

    def by_another_lag(self, model: Scored, added: Sequence[str], step: Step) -> tuple[Scored, Step]:
        """Return a model and the look beside it, or those with another lag where something matters beside the one that was ``added``.

        On a linear machine all lags are one. What bends its motion or its drive decides which of them it is, but not before that is
        there: by itself the wrong one may take more.
        """
        for name in (one for one in added if one in model.names):
            for other in self.other_lags(name, model) if np.isfinite(self.least_beside(model, step)) else ():
                rival = self.fitted(self.in_place(name, other, model))
                if not np.isfinite(rival.left_out):
                    continue
                further = self.look(rival)
                better = self.least_beside(rival, further) < self.least_beside(model, step)
                worse = step if better else further
                self.steps = [one for one in self.steps if one is not worse]
                model, step, name = (rival, further, other) if better else (model, step, name)
        self.windows.place = model.place
        return model, step

    def least_beside(self, model: Scored, step: Step) -> float:
        """Return what is left where the best of a look stands beside its model; infinite where nothing that was found there matters."""
        levels = [(one, step.level) for one in step.named] + [(one, step.level_of_unknown) for one in step.unknown]
        found = [one.left_out for one, level in levels if self.matters(one, model, level)]
        return min(found, default=math.inf) if step.p_value <= self.claims else math.inf

    def beside_another(self, best: Scored | None, before: Scored, step: Step) -> Scored | None:
        """Return two effects, one of which predicts better than the ``best`` of a step but alone takes no share that matters.

        Where two things are missing, that of the other one may hide it: each has to matter beside the other, and both together.
        """
        hidden = next((one for one in step.named if self.beats(one, before, step.level)), None)
        if hidden is None or hidden is best or self.matters(hidden, before, step.level):
            return None
        further = self.look(hidden)
        found = (
            [one for one in further.named if self.matters(one, hidden, further.level)] if further.p_value <= self.claims else []
        )
        for both in found[:1] if found and not self.mends(found[0], hidden, further) else []:
            alone = self.fitted(both.fitted.candidate.without(hidden.beyond(before)), both.fitted)
            if self.matters(both, alone, step.level) and self.matters(both, before, step.level):
                return both
        self.steps.pop()
        self.windows.place = before.place
        return None

    def promised_beside(self, model: Scored, among: Iterable[str]) -> list[Promise]:
        """Return the best promise of each of some effects and unknowns beside a model, what promises most first."""
        fitted, self.windows.place = model.fitted, model.place
        self.windows.kernels.hold(fitted.candidate.effects)
        projection = Projection(fitted)
        probes = [probe for name in among for probe in self.probes(fitted, name)]
        effects = {**self.library, **{name: one.effect for name, one in self.unknowns.items()}}
        return list(best_promises([projection.promise(probe, effects[probe.effect]) for probe in probes]).values())

    def exchanged(self, model: Scored, base: Scored) -> Scored:
        """Return the model with each of several names exchanged for another law of the same driver, or lag, where that leaves less.

        No two laws of one driver are looked for beside each other, and what else is missing may have decided which was found first.
        """
        names = [name for name in model.beyond(base) if name in self.library]
        for name in names if len(names) > 1 else ():
            for other in [*self.of_same_law(name, model), *self.other_lags(name, model)]:
                rival = self.fitted(self.in_place(name, other, model))
                if rival.left_out < model.left_out:
                    model, name = self.resettled(rival), other
        self.windows.place = model.place
        return model

    def of_same_law(self, name: str, model: Scored) -> list[str]:
        """Return the other effects of the library that make of the same driver what a named one does in the same place."""
        law = law_of(self.library[name])
        others = (one for one in self.library if one not in (*model.names, *self.unnamed))
        return [one for one in others if law and law_of(self.library[one]) == law]

    def other_lags(self, name: str, model: Scored) -> list[str]:
        """Return the other effects that make a drive or a sensor late, as a named one does, and may stand beside what else is there."""
        rest = [one for one in model.names if one != name]
        lags = [one for one in self.library if is_lag(self.library[one])] if is_lag(self.library[name]) else []
        return [one for one in lags if one not in model.names and self.may_be_added(one, rest)]

    def in_place(self, name: str, other: str, model: Scored) -> Candidate:
        """Return a model's candidate with another effect in the place of one: a lag as late, others as first found, or as is usual."""
        effect, values = self.library[other], model.fitted.candidate.effects[name]
        units = [[one.unit for one in self.library[each].parameters.values()] for each in (name, other)]
        similar = is_lag(self.library[name]) and is_lag(effect) and units[0] == units[1]
        if similar:
            own = dict(zip(effect.parameters, values.values(), strict=True))
        else:
            found = (one.fitted.candidate.effects for step in self.steps for one in step.named if other in one.names)
            own = dict(next((one[other] for one in found), effect.defaults()))
        return model.fitted.candidate.without([name]).with_effect(other, own)

    def mends(self, further: Scored, model: Scored, step: Step) -> bool:
        """Whether a further name takes no more than a free law over what drives a name that is there.

        Then the law of that one is off in form, which the answer says, and is no second thing that is missing. Of two laws that are
        both forms of that free law the second has to be shown to take more: two functions of one quantity are one.
        """
        named = (self.library[name] for name in model.names if name in self.library and name not in self.windows.forms)
        there = [one for one in named if not one.states]
        forms = [name for name, one in self.unknowns.items() if any(equivalent_laws(one, law) for law in there)]
        fitted = {_added(one.fitted.candidate, model.fitted.candidate): one for one in step.unknown}
        promised = [one for one in self.promised_beside(model, forms) if one.effect not in fitted] if forms else []
        for promise in promised[:FITTED_UNKNOWNS]:
            begun = self.begun_unknown(model.fitted, promise)
            fitted[promise.effect] = self.fitted(begun.candidate, begun)
        level = step.claims / max(len(fitted), 1)
        second = {self.library[name] for name in set(further.names) - set(model.names) if name in self.library}
        shown = (
            one
            for name, one in fitted.items()
            if name in forms
            and (
                one.left_out <= further.left_out
                or (any(equivalent_laws(self.unknowns[name], own) for own in second) and not self.beats(further, one))
            )
        )
        return any(self.matters(one, model, level) for one in shown)

    def better_than_free_laws(self, before: Scored, step: Step) -> Scored | None:
        """Return the effect that leaves less than every free law of the step, where one of these is shown to take what matters.

        That something is missing the free law shows; it is no better news than a name that leaves less, or than one that takes most
        of what the free law takes where that is another form of it. The name need not stand out among all: it has to by itself.
        """
        shown = [one for one in step.unknown if self.matters(one, before, step.level_of_unknown)]
        best = min(shown, key=lambda one: one.left_out, default=None)
        if best is None:
            return None
        free = self.unknowns[_added(best.fitted.candidate, before.fitted.candidate)]
        most = (before.left_out / best.left_out) ** MOST_OF_IT
        for one in step.named:
            form = equivalent_laws(free, self.library[_added(one.fitted.candidate, before.fitted.candidate)])
            takes = one.left_out <= best.left_out or (form and before.left_out / one.left_out >= most)
            if takes and self.matters(one, before, step.claims):
                return one
        return None

    def beside_free_law(self, before: Scored, step: Step) -> Scored | None:
        """Return a model of the step with an effect that matters beside a free law, which matters beside it, and both more than none.

        Where two things are missing, each alone leaves so much that it hardly stands out block by block.
        """
        found = [one for one in step.named if self.error_ratio(one, before) <= 1.0 - MATTERS]
        level = self.claims / max(FITTED_UNKNOWNS * len(found), 1)
        for one in found:
            for promise in self.promised_beside(one, self.unknowns)[:FITTED_UNKNOWNS]:
                begun = self.begun_unknown(one.fitted, promise)
                both = self.fitted(begun.candidate, begun)
                if not self.matters(both, one, level) or not self.matters(both, before, level):
                    continue
                alone = self.fitted(both.fitted.candidate.without(one.beyond(before)), both.fitted)
                if self.matters(both, alone, level):
                    self.with_law = both
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
