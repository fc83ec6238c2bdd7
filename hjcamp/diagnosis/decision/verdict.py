"""What may be said of the tests, by two numbers: the level alpha of the whole answer, and delta, the smallest share that matters.

A gate asks whether something is missing (nested choice), a confidence set what is not ruled out, and the simplest model that suffices
is the answer. Nothing else changes a word; docs/method.md says why the whole answer has the level alpha.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import held_out, squares_of
from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.choice.comparison_of_models import confidence_set, nested_choice, not_worse
from hjcamp.diagnosis.choice.models import MOTION, Models
from hjcamp.diagnosis.decision.by_condition import Differs, differs_by_condition
from hjcamp.diagnosis.decision.periodic_disturbance import Swing, swing_of
from hjcamp.diagnosis.decision.whole_tests import contradicted
from hjcamp.diagnosis.levels import ALPHA, DELTA, MOST_OF_IT
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import advantages, chance_of_t, discrimination, ratio_t
from hjcamp.errors import plain
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
# Looks at what no law explains share a tenth of the level each; an error so many times repeatability (rms) is not nothing.
FURTHER, FAR = 10.0, 2.0
# Levels of models: those with a non-parametric term, and what follows from the motion by no law.
TERMS, LAWLESS = (1, 3), 5
NOTHING, EFFECT, ONE_OF, OUTSIDE, CANNOT_TELL = "nothing_missing", "effect", "one_of", "outside_library", "cannot_tell"


@dataclass(frozen=True)
class Gate:
    """Whether something is missing: p of the nested choice, the share that it explains, its upper bound, and the effective blocks."""

    p_value: float
    gain: float
    upper: float
    blocks: float


@dataclass(frozen=True)
class Verdict:
    """The verdict with the models behind it.

    ``effects`` are what to add, or all that is in one of the sets that are not ruled out (``confidence_set``), of which ``model`` has
    the first; something ``outside`` the library may not be ruled out either. ``named`` and ``terms`` are fits of one candidate.
    ``term`` is the non-parametric term that explains most where no name suffices; ``law_left`` the share of what the best model
    explains that the names leave; ``follows`` the share that follows from the motion where no law does; ``swing`` what oscillates by
    itself, ``differs`` a base for each condition. ``lacking`` says why these tests cannot tell.
    """

    word: str
    gate: Gate
    model: Scored
    named: tuple[Scored, ...]
    terms: tuple[Scored, ...]
    effects: tuple[str, ...] = ()
    confidence_set: tuple[tuple[str, ...], ...] = ((),)
    rivals: tuple[Scored, ...] = ()
    outside: bool = False
    term: Scored | None = None
    law_left: float = 0.0
    follows: float = 0.0
    lacking: tuple[str, ...] = ()
    differs: Differs | None = None
    swing: Swing | None = None
    alpha: float = ALPHA
    delta: float = DELTA

    @property
    def shown(self) -> Scored:
        """The model whose error is shown: of what is outside the library its term tells how much could be gained."""
        return self.term if self.term and not self.effects else self.model


class Decision:
    """The decision between the models of one analysis."""

    def __init__(self, models: Models, alpha: float, delta: float) -> None:
        self.models, self.alpha, self.delta = models, alpha, delta
        self.base, self.channels = models.base, models.analysis.channels
        self.blocks, self.terms = models.blocks, models.terms

    def verdict(self) -> Verdict:
        """Return what may be said."""
        analysis = self.models.analysis
        lacking = tuple(what_lacks(analysis.measured, analysis.windows.layout))
        if lacking:
            return Verdict(
                CANNOT_TELL,
                Gate(1.0, 0.0, math.inf, 0.0),
                self.base,
                (),
                (),
                lacking=lacking,
                alpha=self.alpha,
                delta=self.delta,
            )
        gate = self.gate()
        fits = tuple(self.models.named), tuple(self.models.non_parametric)
        found = Verdict(NOTHING, gate, self.base, *fits, alpha=self.alpha, delta=self.delta)
        if gate.p_value > self.alpha or gate.gain < self.delta:
            return found if gate.upper < self.delta else replace(found, word=CANNOT_TELL, lacking=(self._too_little(gate),))
        return self.said(found, self.parsimonious([one.scored for one in self.models.all]))

    # -- is something missing?

    def gate(self) -> Gate:
        """Return whether each block is predicted better by the model that is best on all others, of those chosen without it."""
        from scipy.special import stdtrit

        base, kept, names = self.base, self.models.all, self.models.names
        scores = np.array([advantages(one.scored.features, base.features, self.blocks) for one in kept])
        allowed = np.array([[b in one.blocks for b in range(len(names))] for one in kept])
        features, fitted = base.features.copy(), base.fitted.features.copy()
        chosen = nested_choice(scores.reshape(len(kept), len(names)), allowed.reshape(len(kept), len(names)))
        for name, best in zip(names, chosen, strict=True):
            rows = self.blocks == name
            if best >= 0:
                features[rows], fitted[rows] = kept[best].scored.features[rows], kept[best].scored.fitted.features[rows]
        t, weight = ratio_t(
            advantages(features, base.features, self.blocks), discrimination(fitted, base.fitted.features, self.blocks)
        )
        gained, count = self.channels.of(base.features**2 - features**2), len(names)
        each = np.array([gained[self.blocks == one].sum(axis=0) for one in names]) / len(features)
        spread = np.sqrt(count / (count - 1.0) * np.sum((each - each.mean(axis=0)) ** 2, axis=0))
        bound = each.sum(axis=0) + float(stdtrit(count - 1.0, 1.0 - self.alpha)) * spread
        upper = np.minimum(bound, self.channels.above(base.features)) / self.channels.excess(base.features)
        p_value = chance_of_t(t, weight) if t > 0.0 else 1.0
        return Gate(p_value, self.share(features, base.features), float(np.max(upper)), weight)

    def share(self, features: Array, before: Array) -> float:
        """Return which share of the base's error above repeatability features (windows, d) explain beyond others."""
        return self.channels.share(features, before, self.base.features)

    def _too_little(self, gate: Gate) -> str:
        return (
            f"up to {100.0 * min(gate.upper, 1.0):.0f} % of the error above repeatability could be explained; these tests show "
            f"{100.0 * max(gate.gain, 0.0):.0f} % (p = {plain(gate.p_value, 2)} over {len(self.models.names)} blocks): more or longer "
            "tests would tell"
        )

    # -- what is not ruled out?

    def parsimonious(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the models each of whose terms explains delta, beyond any model of a part of its terms."""
        by_names = {frozenset(one.beyond(self.base)): one for one in models}
        kept = []
        for names, model in by_names.items():
            parts = [one.features for other, one in by_names.items() if other < names]
            if all(self.share(model.features, part) >= self.delta for part in [*parts, self.base.features]):
                kept.append(model)
        return kept

    def set_of(self, models: Sequence[Scored]) -> list[Scored]:
        """Return the models that are not ruled out."""
        if len(models) < 2:
            return list(models)
        shape = (len(models), len(models), len(self.models.names))
        advantage, apart = np.zeros(shape), np.zeros(shape)
        for i, one in enumerate(models):
            for j, other in enumerate(models):
                if i != j:
                    a, b, a_fitted, b_fitted = self.models.compared(one, other)
                    advantage[i, j] = advantages(a, b, self.blocks)
                    apart[i, j] = discrimination(a_fitted, b_fitted, self.blocks)
        return [models[k] for k in confidence_set(advantage, apart, self.alpha, self.models.search.seed)]

    # -- the simplest that suffices

    def level(self, model: Scored) -> int:
        """Return how simple a model is: one name 0, one non-parametric term 1, two names 2, name and term 3, no law 5."""
        names = model.beyond(self.base)
        if MOTION in names:
            return LAWLESS
        return int(any(name in self.terms for name in names)) + (2 if len(names) > 1 else 0)

    def said(self, found: Verdict, models: Sequence[Scored]) -> Verdict:
        """Return the verdict by the simplest models whose errors are within delta of the least: what differs by less does not matter.

        Of those the confidence set has the last word. Where a law without a name is the simplest, names not ruled out are said.
        """
        outside = replace(found, word=OUTSIDE, confidence_set=(), outside=True, law_left=1.0)
        left, within = self.set_of(models), [models[k] for k in self._as_good(models)]
        simplest = min(
            (self.level(one) for one in within), default=LAWLESS
        )  # where each errs least in another channel no law suffices
        answer = self.set_of([one for one in within if self.level(one) == simplest]) or left
        named = [one for one in left if not self.level(one) % 2] if simplest % 2 else answer
        if not named:
            return self._with_terms(outside, answer, models)
        sets = tuple(one.beyond(self.base) for one in named)
        best = min((one.scored for one in self.models.all), key=lambda one: one.left_out)
        explained = [math.log(self.base.left_out / one.left_out) for one in (named[0], best)]
        shown = replace(
            found,
            word=OUTSIDE if simplest % 2 else EFFECT if len(sets) == 1 else ONE_OF,
            effects=() if simplest % 2 else tuple(dict.fromkeys(name for one in sets for name in one)),
            confidence_set=sets,
            model=self.base if simplest % 2 else named[0],
            rivals=tuple(named[1:]),
            outside=bool(simplest % 2),
            law_left=float(np.clip(1.0 - explained[0] / explained[1], 0.0, 1.0)) if explained[1] > 0.0 else 0.0,
        )
        return self._with_terms(shown, answer, models) if simplest % 2 else replace(shown, term=self._other_shape(named[0]))

    def _other_shape(self, model: Scored) -> Scored | None:
        """Return the non-parametric term that predicts better than a named law: the law has another shape, or more is missing."""
        term = next(iter(self.models.non_parametric), None)
        return term if term is not None and self.models.search.beats(term, model) else None

    def _as_good(self, left: Sequence[Scored]) -> list[int]:
        """Return which models err by no more than delta above the least in every channel."""
        errors = self.channels.left([one.features for one in left], self.base.features)
        return not_worse(errors, self.delta) if left else []

    def _with_terms(self, found: Verdict, answer: Sequence[Scored], models: Sequence[Scored]) -> Verdict:
        """Return what is outside the library with the non-parametric term that explains most, and what follows from the motion.

        Where nothing but a regression on the motion suffices, the best of all ``models`` that explains most of it says what drives it.
        """
        follows = max((self._explained(one) for one in answer if self.level(one) == LAWLESS), default=0.0)
        terms = [one for one in answer if self.level(one) in TERMS]
        if not terms:
            terms = [one for one in models if self.level(one) in TERMS and self._explained(one) > MOST_OF_IT * follows]
        else:
            follows = 0.0
        return replace(found, term=min(terms, key=lambda one: one.left_out, default=None), follows=min(follows, 1.0))

    def _explained(self, model: Scored) -> float:
        """Return which share of the base's error above repeatability a model explains."""
        return self.share(model.features, self.base.features)


def decided(analysis: Analysis, alpha: float = ALPHA, delta: float = DELTA) -> Verdict:
    """Return what may be said of an analysis.

    Nothing is said of a base that a bound keeps away from what is declared. What no law explains is looked at once more.
    """
    found = Decision(Models(analysis, delta), alpha, delta).verdict()
    judged = math.isfinite(found.gate.upper)
    if judged and (held := _held(analysis, found.shown)):
        none = Verdict(CANNOT_TELL, found.gate, analysis.base, found.named, found.terms, alpha=alpha, delta=delta)
        return replace(none, lacking=(*found.lacking, held))
    if judged and found.effects and (grown := contradicted(analysis, found.model, delta)):
        others = all(contradicted(analysis, one, delta) for one in found.rivals)
        return _against_whole_tests(analysis, found, grown) if others else found
    return _without_law(analysis, found) if judged and not (found.effects or found.term) else found


def _against_whole_tests(analysis: Analysis, found: Verdict, grown: str) -> Verdict:
    """Return that none can be told of names with each of which whole tests are explained less."""
    name = " and ".join(found.confidence_set[0]).replace("_", " ")
    said = f"with {name} the error of whole tests grows: {grown}; it may stand for something that acts slowly"
    return replace(
        Verdict(CANNOT_TELL, found.gate, analysis.base, found.named, found.terms, alpha=found.alpha, delta=found.delta),
        lacking=(*found.lacking, said),
    )


def _without_law(analysis: Analysis, found: Verdict) -> Verdict:
    """Return the verdict where no law explains what is missing: something outside swings, or conditions have parameters of their own.

    Both are looked for at a tenth of the level. An error of more than twice repeatability (rms) is not nothing: of repeated tests it is
    something outside; without repetitions nobody can tell it from scatter.
    """
    outside = replace(found, word=OUTSIDE, confidence_set=(), outside=True, law_left=1.0, lacking=())
    if swing := swing_of(analysis, found.alpha / FURTHER):
        return replace(outside, swing=swing)
    least = min(held_out(analysis, one) for one in (*found.named, *found.terms, analysis.base))
    if differs := differs_by_condition(analysis, least, found.alpha / FURTHER):
        return replace(outside, differs=differs)
    over = np.sqrt(
        squares_of(analysis, analysis.base.features)
        / np.maximum(analysis.channels.repeatability.squares[: len(analysis.measured.sensors)], 1.0)
    )
    worst = int(np.argmax(over))
    if over[worst] <= FAR or any(found.confidence_set):
        return found
    if analysis.noise_floor.source == "repetitions":
        return outside
    if found.word != NOTHING:
        return found
    said = (
        f"{analysis.measured.sensors[worst].quantity.replace('_', ' ')} errs by {plain(over[worst], 2)} times its own noise, and "
        "nothing that was tried explains it: without repetitions it may be scatter; repeat a test"
    )
    return replace(found, word=CANNOT_TELL, lacking=(said,))


def _held(analysis: Analysis, model: Scored) -> str:
    """Return in words which base parameter a bound keeps away from what is declared; else nothing.

    It does in the base, and in a model that is nearer to that bound than to what is declared.
    """
    if not analysis.held:
        return ""
    now, base, declared = model.fitted.candidate, analysis.base.fitted.candidate, Candidate(analysis.search.declared, {})
    own = [one for one in model.fitted.free if not one.effect and one.name in analysis.held]
    near = {one.name for one in own if abs(one.of(now) - one.of(base)) < abs(one.of(now) - one.of(declared))}
    name = next((one for one in analysis.held if one in near), "")
    if not name:
        return ""
    return (
        f"{name.replace('_', ' ')} was driven to its bound, far from what is declared: these tests do not determine it, its bounds are "
        "wrong, or it absorbs the missing effect"
    )
