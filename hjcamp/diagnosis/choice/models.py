"""The models of one analysis that may be what is missing: best subsets of linear responses, fitted once each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws, kind_of, law_of
from hjcamp.diagnosis.choice.responses import Responses
from hjcamp.diagnosis.choice.subsets import Column, Ranked, best_settings, kept_by_blocks, pairs_of
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import DELTA
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.kernel_regression import regression_of
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
# Budgets: settings of a candidate that enter pairs, and laws of single candidates of each kind that each block keeps (of pairs one).
SETTINGS, FEW = 2, 2
# Non-parametric terms and names of which every pair is looked at.
FUNCTIONS, NAMES = 3, 5
# What follows from the motion by no law at all, as a model's name.
MOTION = "anything_over_the_motion"


@dataclass(frozen=True)
class Model:
    """A fitted model with the blocks (positions) without which it was chosen: those that it may predict."""

    scored: Scored
    blocks: frozenset[int]


class Models:
    """The models of one analysis, fitted once each."""

    def __init__(self, analysis: Analysis, delta: float = DELTA) -> None:
        self.analysis, self.delta = analysis, delta
        self.search, self.base = analysis.search, analysis.base
        self.blocks = self.search.blocks
        self.names = np.unique(self.blocks)
        self.library, self.terms = self.search.library, self.search.unknowns

    @cached_property
    def all(self) -> tuple[Model, ...]:
        """Every model that competes with the base."""
        fitted = self._fits(self._chosen)
        fitted += self._second_look(fitted)
        every = frozenset(range(len(self.names)))
        return (*fitted, *(Model(one, every) for one in self._lawless([one.scored for one in fitted])))

    def compared(self, one: Scored, other: Scored) -> tuple[Array, Array, Array, Array]:
        """Return the features by which two models are compared, on blocks left out and as fitted: predictions, balances if they can.

        Balances know only roughly what remembers, and what errs in a sensor.
        """
        effects = {
            name: self.library[name] for model in (one, other) for name in model.beyond(self.base) if name in self.library
        }
        blind = any(effect.states or kind_of(effect) == "sensor" for effect in effects.values())
        rows = (one.features, other.features, one.fitted.features, other.fitted.features)
        if not blind:
            return rows
        cut = self.analysis.windows.layout.predictions
        return cut(rows[0]), cut(rows[1]), cut(rows[2]), cut(rows[3])

    @property
    def named(self) -> list[Scored]:
        """The fits of one name by itself, what leaves least first."""
        return self._of_one(self.library)

    @property
    def non_parametric(self) -> list[Scored]:
        """The fits of one non-parametric term by itself, what leaves least first."""
        return self._of_one(self.terms)

    def _of_one(self, among: object) -> list[Scored]:
        own = [one.scored for one in self.all if len(one.scored.beyond(self.base)) == 1]
        return sorted((one for one in own if one.beyond(self.base)[0] in among), key=lambda one: one.left_out)  # type: ignore[operator]

    @cached_property
    def _within_repeatability(self) -> bool:
        """Whether the base leaves less than delta above repeatability in every channel: whatever is fitted, nothing is missing."""
        channels, features = self.analysis.channels, self.base.features
        return bool(np.all(channels.above(features) < self.delta * channels.excess(features)))

    # -- candidates, by their linear responses

    @cached_property
    def _responses(self) -> Responses:
        """The responses of every candidate relative to the base."""
        able = [one for one in (*self.library, *self.terms) if self.search.may_be_added(one, self.base.names)]
        return Responses(self.search, self.base, able)

    @cached_property
    def _chosen(self) -> dict[frozenset[str], frozenset[int]]:
        """The sets of candidates to fit, with the blocks without which each was chosen.

        Where the base is within repeatability they are the best candidates alone, which are shown.
        """
        columns, moments, search = self._responses.columns, self._responses.moments, self.search
        named = [k for k, one in enumerate(columns) if one.name in self.library]
        terms = [k for k, one in enumerate(columns) if one.name in self.terms]
        singles, functions = moments.ranked([(k,) for k in named]), moments.ranked([(k,) for k in terms])
        best = best_settings(singles, columns, SETTINGS)
        if self._within_repeatability:
            shown = [*_first(best_settings(singles, columns, 1), FEW), *_first(best_settings(functions, columns, 1), FEW)]
            names = {columns[one.columns[0]].name for one in shown} | (search.wanted & {one.name for one in columns})
            return {frozenset([name]): frozenset(range(len(self.names))) for name in sorted(names)}
        pairs = moments.ranked(pairs_of(best, columns, lambda a, b: search.may_be_added(b, [*self.base.names, a])))
        first = _first(best_settings(best, columns, 1), NAMES)
        both = moments.ranked([(a.columns[0], b.columns[0]) for a in _first(functions, FUNCTIONS) for b in first])
        kept = kept_by_blocks(
            ((singles, FEW), (functions, FEW), (pairs, 1), (both, 1)), len(self.names), lambda one: self._laws(one, columns)
        )
        found: dict[frozenset[str], set[int]] = {}
        for places, blocks in kept.items():
            found.setdefault(frozenset(columns[one].name for one in places), set()).update(blocks)
        every = set(range(len(self.names)))
        for name in [*self._forms_of({name for names in found for name in names}), *self._asked()]:
            found.setdefault(frozenset([name]), set()).update(every)
        for name in sorted({name for names in found for name in names}):
            found.setdefault(frozenset([name]), set())
        return {names: frozenset(blocks) for names, blocks in found.items()}

    def _laws(self, one: Ranked, columns: Sequence[Column]) -> frozenset[object]:
        """Return what a set of candidates makes of what, whatever the forms."""
        names = [columns[k].name for k in one.columns]
        effects = {name: self.library[name] if name in self.library else self.terms[name].effect for name in names}
        return frozenset(law_of(effect) or name for name, effect in effects.items())

    def _forms_of(self, names: set[str]) -> list[str]:
        """Return the named effects of which a term among these is another form, whatever the linear responses say of their signs."""
        terms = [self.terms[name] for name in names if name in self.terms]
        able = (name for name in self.library if self.search.may_be_added(name, self.base.names))
        return [name for name in able if any(equivalent_laws(one, self.library[name]) for one in terms)]

    def _asked(self) -> list[str]:
        """Return the effects that are fitted whatever they promise: those asked for, and a lag where the base has a delay."""
        search, candidate = self.search, self.base.fitted.candidate
        able = [name for name in self.library if search.may_be_added(name, self.base.names)]
        return [name for name in able if name in search.wanted or search.late_base(name, candidate)]

    # -- fits

    def _fits(self, chosen: dict[frozenset[str], frozenset[int]]) -> list[Model]:
        """Return a fit of every set of candidates, whatever its settings; none that remembers for no time that is shown."""
        search = self.search
        names = [next(iter(one)) for one in chosen if len(one) == 1]
        ones = search.each(self._responses.fitted, names, lambda name: f"fitting {name.replace('_', ' ')}")
        single = {name: one for name, one in zip(names, ones, strict=True) if one is not None}
        # of what one candidate leaves less than delta a second one cannot explain delta
        whole = {name for name, one in single.items() if self._leaves_little(one)}
        sets = [sorted(one) for one in chosen if len(one) > 1 and one <= single.keys() and not one & whole]
        more = search.each(
            lambda own: self._with_several([single[name] for name in own]), sets, lambda own: f"fitting {' with '.join(own)}"
        )
        found = [(frozenset([name]), one) for name, one in single.items()] + list(zip(map(frozenset, sets), more, strict=True))
        return [Model(one, chosen[own]) for own, one in found if self._admissible(one)]

    def _second_look(self, first: Sequence[Model]) -> list[Model]:
        """Return names in addition to the best one, where each of the first models leaves delta of the error above repeatability.

        A curved law may look like nothing relative to the base, and be what is missing as well.
        """
        channels, base = self.analysis.channels, self.base
        if self._within_repeatability or any(self._leaves_little(one.scored) for one in first):
            return []
        found: list[Model] = []
        ones = [one.scored for one in first if len(one.scored.beyond(base)) == 1]
        named = [one for one in ones if one.beyond(base)[0] in self.library]
        best = min(named, key=lambda one: one.left_out, default=base)
        if channels.share(best.features, base.features, base.features) >= self.delta:
            found += self._in_addition(best, self._able(best, first))
        # what acts only behind one that bends what arrives, another lag for example, was not able to stand by itself
        bent = {name for one in found for name in one.scored.names if name in self.library}
        for one in named:
            if bent & set(one.beyond(base)):
                alone = self._able(base, ())
                found += self._in_addition(one, [name for name in self._able(one, found) if name not in alone])
        return found

    def _able(self, model: Scored, known: Sequence[Model]) -> list[str]:
        """Return the names that may be added to a model and that no known one has with it."""
        sets = [frozenset(one.scored.names) for one in known]
        able = (one for one in self.library if self.search.may_be_added(one, model.names))
        return [one for one in able if frozenset((*model.names, one)) not in sets]

    def _in_addition(self, model: Scored, names: Sequence[str]) -> list[Model]:
        """Return the fits of a model with those candidates that each block keeps, of all by their responses relative to it."""
        responses = Responses(self.search, model, names)
        columns = responses.columns
        ranked = best_settings(responses.moments.ranked([(k,) for k in range(len(columns))]), columns, 1)
        chosen = kept_by_blocks(((ranked, FEW),), len(self.names), lambda one: self._laws(one, columns))
        kept = {columns[one].name: blocks for (one,), blocks in chosen.items()}
        fits = self.search.each(responses.fitted, list(kept), lambda name: f"fitting {name.replace('_', ' ')}")
        return [
            Model(one, frozenset(kept[name])) for name, one in zip(kept, fits, strict=True) if one and self._admissible(one)
        ]

    def _admissible(self, model: Scored) -> bool:
        """Whether a fit is finite, and remembers for a time that is shown where it remembers."""
        return bool(np.isfinite(model.left_out)) and not self.search.of_no_memory(model, self.base)

    def _leaves_little(self, model: Scored) -> bool:
        """Whether a model leaves less than delta of the error above repeatability in every channel."""
        [left] = self.analysis.channels.left([model.features], self.base.features)
        return bool(np.all(left < self.delta))

    def _with_several(self, single: Sequence[Scored]) -> Scored:
        """Return the base with several candidates together, from the fits of each by itself, the best first."""
        first, *rest = sorted(single, key=lambda one: one.left_out)
        begun: Candidate = first.fitted.candidate
        for one in rest:
            for name in one.beyond(self.base):
                begun = begun.with_effect(name, one.fitted.candidate.effects[name])
        return self.search.at(first.place).fitted(begun)

    def _lawless(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the base and the best model of names, each with a regression on the motion of what it leaves of blocks left out.

        What they say of a block rests on the others. A model that leaves more than they do is not all that is missing.
        """
        named = [one for one in models if not any(name in self.terms for name in one.names)]
        found, layout = [], self.analysis.windows.layout
        for one in (self.base, *sorted(named, key=lambda one: one.left_out)[:1]):
            regression = regression_of(layout, one.features, self.blocks, layout.readings)
            features = one.features.copy()
            features[regression.rows] = regression.features
            fitted = replace(one.fitted, features=features)
            found.append(replace(one, names=(*one.names, MOTION), fitted=fitted, features=features, left_out=size(features)))
        return found


def _first(ranked: Sequence[Ranked], most: int) -> list[Ranked]:
    """Return those that score most in all blocks together."""
    return sorted(ranked, key=lambda one: -one.scores.sum())[:most]
