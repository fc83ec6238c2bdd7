"""What may be said of the tests by two numbers: the level alpha of the whole answer, and delta, the smallest share that matters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws
from hjcamp.diagnosis.choice.comparison_of_models import confidence_set, nested_choice, not_worse
from hjcamp.diagnosis.choice.kinds import judged
from hjcamp.diagnosis.choice.subsets import Blocks, Column, Ranked, best_settings, kept_by_blocks, pairs_of
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.screening.screening import Probe, Projection
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import advantages, chance_of_t, discrimination, ratio_t
from hjcamp.diagnosis.validation.kernel_regression import regression_of
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
ALPHA, DELTA = 0.05, 0.10
# Budgets: settings of a candidate that enter pairs, and sets that each block keeps of each kind.
SETTINGS, FEW = 2, 2
# Free functions and names of which every pair is looked at.
FUNCTIONS, NAMES = 3, 5
NOTHING, EFFECT, ONE_OF, OUTSIDE, CANNOT_TELL = "nothing_missing", "effect", "one_of", "outside_library", "cannot_tell"
ONE_OR_OUTSIDE = "one_of_or_outside"
# What follows from the motion by no law at all, as a model's name.
MOTION = "anything_over_the_motion"


@dataclass(frozen=True)
class Chosen:
    """What may be said, with what it rests on: gains by the nested choice (sensors,), p, blocks, and the models not ruled out."""

    word: str
    effects: tuple[str, ...]
    sets: tuple[tuple[str, ...], ...]
    p_value: float
    gain: float
    upper: float
    blocks: int
    fitted: int

    def row(self, alpha: float, delta: float) -> dict[str, Any]:
        """Return it as plain values."""
        return {
            "verdict": self.word, "effects": list(self.effects), "confidence_set": [list(one) for one in self.sets],
            "p_value": self.p_value, "gain": self.gain, "upper": self.upper if math.isfinite(self.upper) else None,
            "blocks": self.blocks, "models": self.fitted, "alpha": alpha, "delta": delta,
        }  # fmt: skip


class Page:
    """The models of one analysis, fitted once each, and what may be said of them."""

    def __init__(self, analysis: Analysis, alpha: float = ALPHA, delta: float = DELTA) -> None:
        self.analysis, self.alpha, self.delta = analysis, alpha, delta
        kinds = judged(analysis)
        self.search, self.base, self.repeatability = kinds.search, kinds.base, kinds.repeatability
        self.channels = kinds.channels
        self.layout = analysis.windows.layout
        self.blocks = self.search.blocks
        self.names = np.unique(self.blocks)

    def chosen(self) -> Chosen:
        """Return what may be said."""
        if what_lacks(self.analysis.measured, self.layout):
            return Chosen(CANNOT_TELL, (), ((),), 1.0, 0.0, math.inf, len(self.names), 0)
        kept = self.kept()
        kept += [(one, set(range(len(self.names)))) for one in self.lawless([one for one, _ in kept])]
        models = [one for one, _ in kept]
        nested = self.nested(kept)
        p, gain, upper = self.gate(nested)
        if p > self.alpha or gain < self.delta:
            word = NOTHING if upper < self.delta else CANNOT_TELL
            return Chosen(word, (), ((),), p, gain, upper, len(self.names), len(models))
        left = self.set_of(self.parsimonious(models))
        word, effects, sets = self.said(left)
        return Chosen(word, effects, sets, p, gain, upper, len(self.names), len(models))

    # -- candidates

    @cached_property
    def projection(self) -> Projection:
        """The residuals of the base, white."""
        return Projection(self.base.fitted)

    @cached_property
    def probes(self) -> list[Probe]:
        """The responses of every candidate relative to the base, at each setting of its shapes."""
        search, fitted = self.search, self.base.fitted
        search.windows.place = self.base.place
        search.windows.kernels.hold(fitted.candidate.effects)
        names = [one for one in (*search.library, *search.unknowns) if search.may_be_added(one, fitted.candidate.effects)]
        search.windows.kernels.prepare(names)
        found = search.each(
            lambda name: search.probes(fitted, name), names, lambda name: f"responses of {name.replace('_', ' ')}"
        )
        return [probe for one in found for probe in one]

    def columns(self) -> list[Column]:
        """Return the responses as white columns, with what is known of their amplitudes."""
        white = self.projection.whitener
        found = []
        for k, probe in enumerate(self.probes):
            free = self.search.unknowns.get(probe.effect)
            known = float(probe.sizes[0] / free.usual) ** 2 if free else 0.0
            responses = np.einsum("wfk,fg->wgk", probe.responses, white).reshape(-1, probe.responses.shape[2])
            found.append(Column(probe.effect, k, responses, known, probe.one_sided))
        return found

    def kept(self) -> list[tuple[Scored, set[int]]]:
        """Return the fitted models with the blocks without which each was chosen."""
        columns, fitted, search = self.columns(), self.base.fitted, self.search
        free = [k for k, one in enumerate(fitted.free) if not one.bounded(fitted.candidate)]
        white = self.projection.whitener
        slopes = np.einsum("wfp,fg->wgp", fitted.slopes[:, :, free], white).reshape(-1, len(free))
        residuals, d = (fitted.features @ white).ravel(), fitted.features.shape[1]
        prior = np.diag([fitted.free[k].slope ** 2 for k in free]) if free else np.zeros((0, 0))
        rows = np.searchsorted(self.names, np.repeat(self.blocks, d))
        named = [k for k, one in enumerate(columns) if one.name in search.library]
        laws = [k for k, one in enumerate(columns) if one.name in search.unknowns]
        moments = Blocks(residuals, slopes, prior, columns, rows)
        singles, functions = moments.ranked([(k,) for k in named]), moments.ranked([(k,) for k in laws])
        best = best_settings(singles, columns, SETTINGS)
        pairs = moments.ranked(pairs_of(best, columns, lambda a, b: search.may_be_added(b, [*self.base.names, a])))
        first = _first(best_settings(best, columns, 1), NAMES)
        both = moments.ranked([(a.columns[0], b.columns[0]) for a in _first(functions, FUNCTIONS) for b in first])
        chosen = kept_by_blocks((singles, pairs, functions, both), len(self.names), FEW)
        for name in self.forms_of([columns[c].name for one in chosen for c in one if c in laws]):
            own = (
                _first([one for one in singles if columns[one.columns[0]].name == name], 1)
                or [Ranked((k,), np.zeros(len(self.names))) for k in named if columns[k].name == name][:1]
            )
            for one in own:
                chosen.setdefault(one.columns, set()).update(range(len(self.names)))
        return self.fits(chosen, columns)

    def forms_of(self, laws: Sequence[str]) -> set[str]:
        """Return the named effects of which a free function is another form, whatever the linear responses say of their signs."""
        search = self.search
        free = [search.unknowns[name] for name in set(laws)]
        able = (name for name in search.library if search.may_be_added(name, self.base.names))
        return {name for name in able if any(equivalent_laws(one, search.library[name]) for one in free)}

    def fits(self, chosen: dict[tuple[int, ...], set[int]], columns: Sequence[Column]) -> list[tuple[Scored, set[int]]]:
        """Return a fit of every set of candidates, whatever its settings, with the blocks that chose it."""
        by_names: dict[frozenset[str], set[int]] = {}
        for places, blocks in chosen.items():
            by_names.setdefault(frozenset(columns[one].name for one in places), set()).update(blocks)
        single = {name: self.of_one(name) for name in sorted({name for names in by_names for name in names})}
        by_names |= {frozenset([name]): by_names.get(frozenset([name]), set()) for name in single}
        found = []
        for names, blocks in by_names.items():
            model = single[next(iter(names))] if len(names) == 1 else self.of_several([single[one] for one in sorted(names)])
            if model is not None and np.isfinite(model.left_out) and not self.search.of_no_memory(model, self.base):
                found.append((model, blocks))
        return found

    def of_one(self, name: str) -> Scored | None:
        """Return the base with one candidate, from starts of its own; one that the search has fitted is taken over."""
        for step in self.search.steps:
            if step.before is self.base:
                for one in (*step.named, *step.unknown):
                    if one.beyond(self.base) == (name,):
                        return one
        search, effects = self.search, {**self.search.library, **{k: one.effect for k, one in self.search.unknowns.items()}}
        search.windows.place = self.base.place
        promises = [self.projection.promise(one, effects[name]) for one in self.probes if one.effect == name]
        if not promises:
            return None
        if name in search.unknowns:
            begun = search.begun_unknown(self.base.fitted, promises[0])
        else:
            begun = search.begun(self.projection, name, promises)
        return search.fitted(begun.candidate, begun) if np.isfinite(begun.loss) else None

    def of_several(self, single: Sequence[Scored | None]) -> Scored | None:
        """Return the base with several candidates together, from the fits of each by itself, the best first."""
        fits = sorted((one for one in single if one is not None), key=lambda one: one.left_out)
        if len(fits) < len(single):
            return None
        begun: Candidate = fits[0].fitted.candidate
        for one in fits[1:]:
            for name in one.beyond(self.base):
                begun = begun.with_effect(name, one.fitted.candidate.effects[name])
        self.search.windows.place = fits[0].place
        return self.search.fitted(begun)

    def lawless(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the base and the best model of names, each with a regression on the motion of what it leaves of blocks left out.

        What they say of a block rests on the others. A model that leaves more than they do is not all that is missing.
        """
        named = sorted((one for one in models if not self.level(one) % 2), key=lambda one: one.left_out)[:1]
        found = []
        for one in (self.base, *named):
            regression = regression_of(self.layout, one.features, self.blocks, self.layout.readings)
            features = one.features.copy()
            features[regression.rows] = regression.features
            fitted = replace(one.fitted, features=features)
            found.append(replace(one, names=(*one.names, MOTION), fitted=fitted, features=features, left_out=size(features)))
        return found

    # -- decision

    def errors(self, features: Array) -> Array:
        """Return the mean square of features (windows, d) of each channel (channels,), in units of its noise."""
        return self.by_channel(np.mean(features**2, axis=0))

    def by_channel(self, squares: Array) -> Array:
        """Return the means (..., channels) of numbers (..., d) over the features of each channel: of a sensor, of a balance."""
        return np.stack([squares[..., one].mean(axis=-1) for one in self.channels], axis=-1)

    def above(self, features: Array) -> Array:
        """Return the mean square of features (windows, d) above repeatability (channels,)."""
        return np.asarray(np.maximum(self.errors(features) - self.repeatability.squares, 0.0))

    @cached_property
    def excess(self) -> Array:
        """The base's mean square above repeatability (channels,), and as much as that is unsure."""
        return self.above(self.base.features) + self.repeatability.unsure

    def share(self, features: Array, before: Array | None = None) -> float:
        """Return which share of the error above repeatability features (windows, d) explain beyond others, in the best channel."""
        other = self.base.features if before is None else before
        return float(np.max((self.above(other) - self.above(features)) / self.excess))

    def nested(self, kept: Sequence[tuple[Scored, set[int]]]) -> tuple[Array, Array]:
        """Return the features (windows, d) of the nested choice, on blocks left out and as fitted."""
        base, out, fitted = self.base, self.base.features.copy(), self.base.fitted.features.copy()
        scores = np.array([advantages(one.features, base.features, self.blocks) for one, _ in kept]).reshape(
            len(kept), len(self.names)
        )
        allowed = np.array([[b in blocks for b in range(len(self.names))] for _, blocks in kept]).reshape(scores.shape)
        for name, best in zip(self.names, nested_choice(scores, allowed), strict=True):
            rows = self.blocks == name
            if best >= 0:
                out[rows], fitted[rows] = kept[best][0].features[rows], kept[best][0].fitted.features[rows]
        return out, fitted

    def gate(self, nested: tuple[Array, Array]) -> tuple[float, float, float]:
        """Return p of the nested choice against the base, the share that it explains, and that share's upper bound."""
        from scipy.special import stdtrit

        features, fitted = nested
        base, count = self.base, len(self.names)
        t, weight = ratio_t(
            advantages(features, base.features, self.blocks), discrimination(fitted, base.fitted.features, self.blocks)
        )
        gain = self.by_channel(base.features**2 - features**2)
        each = np.array([gain[self.blocks == one].sum(axis=0) for one in self.names]) / len(features)
        spread = np.sqrt(count / (count - 1.0) * np.sum((each - each.mean(axis=0)) ** 2, axis=0))
        bound = each.sum(axis=0) + float(stdtrit(count - 1.0, 1.0 - self.alpha)) * spread
        upper = np.minimum(bound, self.above(base.features)) / self.excess
        return (chance_of_t(t, weight) if t > 0.0 else 1.0), self.share(features), float(np.max(upper))

    def parsimonious(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the models each of whose terms explains delta, beyond any model of a part of its terms."""
        by_names = {frozenset(one.beyond(self.base)): one for one in models}
        kept = []
        for names, model in by_names.items():
            parts = [one.features for other, one in by_names.items() if other < names] or [self.base.features]
            if all(self.share(model.features, part) >= self.delta for part in [*parts, self.base.features]):
                kept.append(model)
        return kept

    def set_of(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the models that are not ruled out."""
        if len(models) < 2:
            return list(models)
        shape = (len(models), len(models), len(self.names))
        advantage, apart = np.zeros(shape), np.zeros(shape)
        for i, one in enumerate(models):
            for j, other in enumerate(models):
                if i != j:
                    advantage[i, j] = advantages(one.features, other.features, self.blocks)
                    apart[i, j] = discrimination(one.fitted.features, other.fitted.features, self.blocks)
        return [models[k] for k in confidence_set(advantage, apart, self.alpha, self.search.seed)]

    def level(self, model: Scored) -> int:
        """Return how simple a model is: one name 0, one free function 1, two names 2, name and free function 3, no law 5."""
        names = model.beyond(self.base)
        if MOTION in names:
            return 5
        free = any(name in self.search.unknowns for name in names)
        return (1 if free else 0) + (2 if len(names) > 1 else 0)

    def said(self, left: Sequence[Scored]) -> tuple[str, tuple[str, ...], tuple[tuple[str, ...], ...]]:
        """Return the word, the effects, and the sets of the simplest models that err as little as the best."""
        if not left:
            return OUTSIDE, (), ()
        within = [left[k] for k in not_worse([self.above(one.features) / self.excess for one in left], self.delta)]
        if not within:  # each errs least in another sensor
            free = all(self.level(one) % 2 for one in left)
            return (OUTSIDE if free else CANNOT_TELL), (), tuple(one.beyond(self.base) for one in left)
        simplest = min(self.level(one) for one in within)
        answer = self.set_of([one for one in within if self.level(one) == simplest])
        # a law without a name is the simplest that suffices: names that it does not rule out are still said
        shown = [one for one in left if not self.level(one) % 2] if simplest % 2 else answer
        sets = tuple(one.beyond(self.base) for one in (shown or answer))
        if not shown:
            return OUTSIDE, (), sets
        effects = tuple(dict.fromkeys(name for one in sets for name in one))
        return (ONE_OR_OUTSIDE if simplest % 2 else EFFECT if len(sets) == 1 else ONE_OF), effects, sets


def _first(ranked: Sequence[Ranked], most: int) -> list[Ranked]:
    """Return those that score most in all blocks together."""
    return sorted(ranked, key=lambda one: -one.scores.sum())[:most]
