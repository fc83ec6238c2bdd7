"""What may be said of the tests: nothing is missing, this effect, one of these, something outside the library, or cannot tell."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.multistart import above_noise
from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.calibration.window_length import longest_width
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws
from hjcamp.diagnosis.data.repeatability import in_units, usual_size
from hjcamp.diagnosis.data.segments import SHORTEST
from hjcamp.diagnosis.decision.borne_out import not_borne_out
from hjcamp.diagnosis.decision.by_condition import Differs, differs_by_condition
from hjcamp.diagnosis.decision.doubts import doubt_of_names, doubt_of_nothing, doubt_of_outside, held_by_bounds
from hjcamp.diagnosis.decision.free_laws import forms_of, further_law, simpler
from hjcamp.diagnosis.decision.given_constants import Constant, constants_otherwise
from hjcamp.diagnosis.decision.periodic_disturbance import Swing, swing_of
from hjcamp.diagnosis.decision.rivals import confidence_set, ruled_out, taken
from hjcamp.diagnosis.levels import LEVEL, LONGER, MOST_OF_IT
from hjcamp.diagnosis.selection.scored import Scored, Step

NOTHING, EFFECT, ONE_OF, OUTSIDE, CANNOT_TELL = "nothing_missing", "effect", "one_of", "outside_library", "cannot_tell"


@dataclass(frozen=True)
class Verdict:
    """The verdict with the model behind it.

    ``effects`` are what to add, or the group that cannot be told apart, of which ``model`` has one set;
    ``confidence_set`` every set of names that the tests do not rule out; ``law_left`` the share that the named laws leave of
    what the freest law takes; ``unknown`` the unknown that takes it; ``follows`` the share of the error
    that follows from the motion though no law takes it; ``refused`` are names that take less than half of what it takes; ``swing`` is
    what swings by itself; ``differs`` a base for each condition that leaves less than what was found; ``constants`` of the
    plant's file of which another value leaves no more; ``rivals`` are the models of
    all sets but the first.
    """

    word: str
    effects: tuple[str, ...]
    model: Scored
    p_value: float
    confidence_set: tuple[tuple[str, ...], ...]
    law_left: float
    unknown: Scored | None
    lacking: tuple[str, ...]
    follows: float = 0.0
    refused: tuple[str, ...] = ()
    swing: Swing | None = None
    differs: Differs | None = None
    constants: tuple[Constant, ...] = ()
    rivals: tuple[Scored, ...] = ()

    @property
    def shown(self) -> Scored:
        """The model whose error is shown: of what is outside the library its free law tells how much could be gained."""
        return self.unknown if self.unknown and not self.effects else self.model


def agreed(analysis: Analysis, at: Callable[[int], Analysis]) -> tuple[Analysis, Verdict]:
    """Return the verdict and the analysis that it is of; ``at`` gives the same analysis over windows of another width."""
    analysis, verdict = _looked_at(analysis, at)
    verdict = _beside_a_course(analysis, _of_no_constant(analysis, verdict))
    return analysis, _of_other_base(analysis, _doubted(analysis, _swinging(analysis, verdict)))


def _of_other_base(analysis: Analysis, verdict: Verdict) -> Verdict:
    """Return the verdict with a base of another kind where that leaves no more than what was found.

    It has other parameters in each condition, or a constant that the plant's file gives is another one. What no law explains and no
    repetition shows to be more than scatter is explained where each condition has parameters of its own.
    """
    if verdict.word == CANNOT_TELL and analysis.search.steps and not analysis.held:
        differs = differs_by_condition(analysis, _least(analysis), None)
        found = replace(verdict, word=OUTSIDE, confidence_set=(), law_left=1.0, lacking=(), differs=differs)
        return found if differs else verdict
    if verdict.word not in (OUTSIDE, EFFECT, ONE_OF) or verdict.swing:
        return verdict
    rival, least = verdict.model if verdict.effects else verdict.unknown, _least(analysis)
    constants = constants_otherwise(analysis, least, rival)
    return replace(verdict, differs=differs_by_condition(analysis, least, rival), constants=constants)


def _swinging(analysis: Analysis, verdict: Verdict) -> Verdict:
    """Return that something outside the library is missing where no law is found and what is left swings by itself."""
    if verdict.word not in (NOTHING, OUTSIDE) or verdict.unknown:
        return verdict
    swing = swing_of(analysis)
    return (
        replace(verdict, word=OUTSIDE, p_value=swing.chance, confidence_set=(), law_left=1.0, swing=swing) if swing else verdict
    )


def _of_no_constant(analysis: Analysis, verdict: Verdict) -> Verdict:
    """Return that something outside the library is missing where a parameter that is no constant takes what no law of a place does.

    It is looked for where no name takes it and a base leaves more than the noise by chance, and so is what drifts. Of what follows
    from the motion it has to take most, and to predict better than the law of a place that takes some.
    """
    search, base = analysis.search, analysis.base
    if verdict.word not in (NOTHING, OUTSIDE) or not above_noise(analysis.windows.layout, base.fitted.features):
        return verdict
    if verdict.unknown is None and held_by_bounds(analysis):  # what a bound keeps from the base another law would take
        return verdict
    search.claims = LEVEL / (2.0 * (len(LONGER) + 1))
    step = search.look_at_values(base)
    model = _left(analysis, base, step) or _course(analysis, base)
    if model is None or (verdict.follows and _left_by_motion(analysis, model) > 1.0 - MOST_OF_IT):
        return verdict
    if verdict.unknown is not None and not search.beats(model, verdict.unknown):
        return verdict
    if verdict.word == NOTHING and not_borne_out(analysis, step, model):
        return verdict
    return replace(verdict, word=OUTSIDE, p_value=step.told, confidence_set=(), unknown=model, law_left=1.0, follows=0.0)


def _beside_a_course(analysis: Analysis, verdict: Verdict) -> Verdict:
    """Return the verdict with the law over time that takes most of what its names leave, where that is twice what repetitions tell.

    Without repetitions it is held against the noise: where something drifts alike moments differ by that. No law is laid beside a
    name that it makes needless.
    """
    layout, base, model = analysis.windows.layout, analysis.base, verdict.model
    if verdict.word not in (EFFECT, ONE_OF) or verdict.unknown is not None:
        return verdict
    left = in_units(np.mean(model.fitted.features**2, axis=0), layout)
    noise = in_units(np.ones(model.fitted.features.shape[1]), layout)
    least = analysis.noise_floor.of_sensors(layout) if analysis.noise_floor.source == "repetitions" else noise
    if not np.any(least < (1.0 - MOST_OF_IT) * left):
        return verdict
    analysis.search.admit(analysis.search.drifts())
    course = _course(analysis, model)
    if course is None or any(_covered(analysis, model, course, name) for name in model.beyond(base)):
        return verdict
    law_left = 1.0 - taken(base, model) / taken(base, course)
    return replace(verdict, unknown=course, law_left=max(verdict.law_left, law_left))


def _looked_at(analysis: Analysis, at: Callable[[int], Analysis]) -> tuple[Analysis, Verdict]:
    """Return the verdict over windows of several widths.

    Where no law is seen, longer windows are looked at: what acts slowly or in few places hardly shows in short ones. Tests that are
    simulated through are looked at in windows, of which there are more blocks, also where a free law alone is shown that leaves
    more than a name. All of these looks, and one at parameters that are no constants, may together claim something by chance half as
    often as the first.
    Without repetitions one set of names must be what windows of half the length do not rule out; where they name another
    set, both are what the tests leave.
    """
    verdict, width, through = judged(analysis), analysis.windows.layout.width, analysis.windows.layout.memory > 0
    looks = (1,) if through else LONGER
    open_still = verdict.word == NOTHING or bool(verdict.follows) or (through and _left_less_by_a_name(analysis, verdict))
    # of few samples windows cannot be as much longer as is asked for
    most = max(longest_width(analysis.measured), 2 * width)
    for wide in dict.fromkeys(min(times * width, most) for times in looks) if open_still else ():
        seen = _over(analysis, at, wide)
        if seen is None:
            break
        seen.search.claims = LEVEL / (2.0 * (len(looks) + 1))
        other = judged(seen)
        if other.word == CANNOT_TELL:
            break
        # what takes too little in short windows is no better news in long ones
        refused = set(other.effects) & set(verdict.refused) or (verdict.follows and _takes_too_little(analysis, other))
        if other.word != NOTHING and not other.follows and not refused:
            return seen, other
        if verdict.word == NOTHING and other.follows:
            analysis, verdict = seen, other
    if verdict.follows:
        return analysis, verdict
    if verdict.word == EFFECT and not through and (more := _more_in_longer(analysis, verdict, at)):
        return more
    half = width if through else min(max(width // 2, SHORTEST), width)
    if verdict.word != EFFECT or analysis.measured.repeated or (half == width and not through):
        return analysis, verdict
    other = judged(at(half))
    known = {frozenset(names) for names in other.confidence_set}
    if other.word not in (EFFECT, ONE_OF) or frozenset(verdict.effects) in known:
        return analysis, verdict
    sets = (verdict.effects, *(names for names in other.confidence_set if _not_ruled_out(analysis, names, verdict)))
    if len(sets) == 1:
        return analysis, verdict
    group = tuple(dict.fromkeys(name for names in sets for name in names))
    return analysis, replace(verdict, word=ONE_OF, effects=group, confidence_set=sets)


def _not_ruled_out(analysis: Analysis, names: tuple[str, ...], verdict: Verdict) -> bool:
    """Whether a set of names that other windows leave is not ruled out by what these windows have found."""
    search, candidate = analysis.search, analysis.base.fitted.candidate
    for name in names:
        fits = [one.fitted.candidate.effects[name] for step in search.steps for one in step.named if name in one.names]
        candidate = candidate.with_effect(name, fits[0] if fits else search.library[name].defaults())
    return not ruled_out(analysis, search.fitted(candidate), verdict.unknown or verdict.model, analysis.base)


def _over(analysis: Analysis, at: Callable[[int], Analysis], width: int) -> Analysis | None:
    """Return the analysis over windows of a width; none where a test is shorter, or the plant cannot be predicted so far."""
    if width > min(test.samples for test in analysis.measured.tests):
        return None
    seen = at(width)
    return seen if seen.windows.layout.width >= width else None


def _more_in_longer(analysis: Analysis, verdict: Verdict, at: Callable[[int], Analysis]) -> tuple[Analysis, Verdict] | None:
    """Return the verdict over windows that are longer where all its sets have the same names and more: what acts slowly beside them."""
    seen = _over(analysis, at, LONGER[0] * analysis.windows.layout.width)
    if seen is None:
        return None
    seen.search.claims = LEVEL / 2.0
    other = judged(seen)
    more = other.word in (EFFECT, ONE_OF) and all(set(names) > set(verdict.effects) for names in other.confidence_set)
    return (seen, other) if more else None


def _takes_too_little(analysis: Analysis, other: Verdict) -> bool:
    """Whether what longer windows name takes, in these, less than most of what follows from the motion."""
    if not other.effects:
        return False
    candidate = analysis.base.fitted.candidate
    for name in other.model.beyond(analysis.base):
        candidate = candidate.with_effect(name, other.model.fitted.candidate.effects[name])
    return _left_by_motion(analysis, analysis.search.fitted(candidate)) > 1.0 - MOST_OF_IT


def _left_by_motion(analysis: Analysis, model: Scored) -> float:
    """Return which share of all that a model and a regression on the motion beside it take is the regression's."""
    more = analysis.search.follows_motion(model).taken
    return more / (max(taken(analysis.base, model), 0.0) + more) if more else 0.0


def _left_less_by_a_name(analysis: Analysis, verdict: Verdict) -> bool:
    """Whether a named effect leaves less than the free law for which something outside the library is said to be missing."""
    if verdict.word != OUTSIDE or verdict.unknown is None:
        return False
    return any(one.left_out <= verdict.unknown.left_out for one in analysis.search.steps[0].named)


def _doubted(analysis: Analysis, verdict: Verdict) -> Verdict:
    """Return that these tests cannot tell, where something speaks against what would be said."""
    if verdict.word == NOTHING:
        doubt = doubt_of_nothing(analysis, verdict.p_value)
    elif verdict.word == OUTSIDE:
        # what swings by itself does so beside whatever base
        doubt = "" if verdict.swing else doubt_of_outside(analysis, verdict.unknown, verdict.p_value)
    else:
        doubt = doubt_of_names(analysis, verdict.model, verdict.effects)
    if not doubt:
        return verdict
    return Verdict(CANNOT_TELL, (), analysis.base, verdict.p_value, ((),), 0.0, None, (doubt,))


def judged(analysis: Analysis) -> Verdict:
    """Search for what is missing, and return what may be said."""
    search, base = analysis.search, analysis.base
    lacking = tuple(what_lacks(analysis.measured, analysis.windows.layout))
    if lacking:
        return Verdict(CANNOT_TELL, (), base, 1.0, ((),), 0.0, None, lacking)
    model = search.run(base)
    added = model.beyond(base)
    last = next((step for step in reversed(search.steps) if step.before is model), None) or search.look(model)
    first = search.steps[0]
    unknown = _left(analysis, model, last) or _beside(analysis, model)
    p_value = first.told
    if not added:
        follows = search.follows_motion(base).share if unknown is None else 0.0
        if unknown is None and not follows and not _far_above_floor(analysis, base):
            return Verdict(NOTHING, (), base, p_value, ((),), 0.0, None, ())
        if unknown is not None and (wrong := not_borne_out(analysis, first, unknown)):
            return Verdict(CANNOT_TELL, (), base, p_value, ((),), 0.0, None, (wrong,))
        return Verdict(OUTSIDE, (), base, p_value, (), 1.0, unknown, (), follows)
    # what repetitions share is hardly touched: whatever was found is not what is missing
    removable = math.log(base.left_out / _least(analysis))
    if _far_above_floor(analysis, model) and taken(base, model) < MOST_OF_IT * removable:
        return Verdict(OUTSIDE, (), base, p_value, (), 1.0, unknown, ())
    if _hardly_touched(analysis, model):
        return Verdict(OUTSIDE, (), base, p_value, (), 1.0, unknown, ())
    # a regression on the motion is the freest law of all; what a free law takes beside the names is not laid at their door
    freest = unknown or model
    law_left, took = _left_by_motion(analysis, freest), taken(base, model)
    if law_left > 1.0 - MOST_OF_IT:
        share = search.follows_motion(base).share if unknown is None else 0.0
        return Verdict(OUTSIDE, (), base, p_value, (), law_left, unknown, (), share, added)
    if unknown is not None and set(added) <= search.needed:
        # a name that shows beside a free law alone, and takes less than most of what that takes by itself, is not the news
        shown = [one for one in first.unknown if search.matters(one, base, first.level_of_unknown)]
        law = min([_alone(analysis, unknown, added), *shown], key=lambda one: one.left_out)
        if took < MOST_OF_IT * taken(base, law):
            return Verdict(OUTSIDE, (), base, p_value, (), 1.0 - took / taken(base, law), law, (), 0.0, added)
    if unknown is not None:
        left = tuple(name for name in added if not _covered(analysis, model, unknown, name))
        if not left:
            law_left = max(law_left, 1.0 - took / max(taken(base, unknown), 1e-12))
            return Verdict(OUTSIDE, (), base, p_value, (), law_left, _alone(analysis, unknown, added), ())
        if left != added:
            covered = set(added) - set(left)
            model, unknown = (search.fitted(one.fitted.candidate.without(covered)) for one in (model, unknown))
            added, took = left, taken(base, model)
        law_left = max(law_left, 1.0 - took / max(taken(base, unknown), 1e-12))
    while (held := further_law(analysis, model, unknown)) is not None:
        before, unknown = held
        model, added, law_left = before, before.beyond(base), 1.0 - taken(base, before) / taken(base, unknown)
    formed = next((one for one in first.unknown if forms_of(analysis, one, model, added)), None)
    if formed is not None:
        added = forms_of(analysis, formed, model, added)
        model, unknown = search.fitted(model.fitted.candidate.without(set(model.beyond(base)) - set(added))), formed
        law_left = max(law_left, 1.0 - taken(base, model) / taken(base, formed))
    alone = next((one for one in first.unknown if simpler(analysis, one, model, added)), None)
    if alone is not None:
        return Verdict(OUTSIDE, (), base, p_value, (), 1.0, alone, ())
    models = confidence_set(analysis, model, added, unknown)
    sets = tuple(tuple(name for name in one.beyond(base) if name in search.library) for one in models)
    if len(sets) > 1:
        group = tuple(dict.fromkeys(name for one in sets for name in one))
        return Verdict(ONE_OF, group, model, p_value, sets, max(law_left, 0.0), unknown, (), rivals=tuple(models[1:]))
    return Verdict(EFFECT, added, model, p_value, sets, max(law_left, 0.0), unknown, ())


def _far_above_floor(analysis: Analysis, model: Scored) -> bool:
    """Whether repetitions share most of what a model leaves, in most windows: a thing is missing, whatever it depends on.

    What a model misses in few windows alone, about reversals for one, is no such thing.
    """
    noise_floor = analysis.noise_floor
    return noise_floor.usual < (1.0 - MOST_OF_IT) * usual_size(model.features, noise_floor.moments)


def _hardly_touched(analysis: Analysis, model: Scored) -> bool:
    """Whether a model leaves most of what lies above the difference of alike moments, in every sensor that errs twice as much (rms)."""
    layout, noise_floor = analysis.windows.layout, analysis.noise_floor
    if noise_floor.source != "near_replicates":
        return False
    least = noise_floor.of_sensors(layout)
    before, after = (in_units(np.mean(one.features**2, axis=0), layout) for one in (analysis.base, model))
    share = 1.0 - MOST_OF_IT
    far = least < share * before
    left = (least < share * after) & (after - least > share * (before - least))
    return bool(far.any() and left[far].all())


def _least(analysis: Analysis) -> float:
    """Return the size of the floor."""
    moments = analysis.noise_floor.moments
    return math.exp(0.5 * float(np.linalg.slogdet(moments)[1]) / len(moments))


def _left(analysis: Analysis, model: Scored, last: Step) -> Scored | None:
    """Return the best unknown that still takes a share that matters beside the model."""
    if last.p_value > last.claims:
        return None
    found = [one for one in last.unknown if analysis.search.matters(one, model, last.level_of_unknown)]
    return min(found, key=lambda one: one.left_out) if found else None


def _course(analysis: Analysis, model: Scored) -> Scored | None:
    """Return the law over time that takes most of what a model leaves, block by block.

    What drifts looks alike at any time: moved in time it promises as much, and does not stand out from chance by what it promises.
    """
    search = analysis.search
    found = search.courses(model)
    taking = [one for one in found if search.error_ratio(one, model) <= 1.0 - MOST_OF_IT]
    shown = [one for one in taking if search.matters(one, model, search.claims / len(found))]
    return min(shown, key=lambda one: one.left_out, default=None)


def _beside(analysis: Analysis, model: Scored) -> Scored | None:
    """Return the model with the free law beside which a name of it was found; none where no name needed one."""
    search = analysis.search
    if search.with_law is None or not search.needed & set(model.names):
        return None
    if set(model.names) <= set(search.with_law.names) and len(search.with_law.names) == len(model.names) + 1:
        return search.with_law
    candidate = model.fitted.candidate
    for name, own in search.with_law.fitted.candidate.effects.items():
        candidate = candidate if name in model.names or name in search.library else candidate.with_effect(name, own)
    both = search.fitted(candidate)
    return both if search.matters(both, model) else None


def _covered(analysis: Analysis, model: Scored, unknown: Scored, name: str) -> bool:
    """Whether a free law makes a named effect needless that takes less than most of what it takes: then it is not that effect.

    A law that is no other form of the effect says where it is missing: beside one that predicts better it need not take that little.
    """
    search = analysis.search
    rest = search.fitted(unknown.fitted.candidate.without([name]))
    if search.matters(unknown, rest):
        return False
    laws = [search.unknowns[one] for one in rest.names if one in search.unknowns]
    if not any(equivalent_laws(law, search.library[name]) for law in laws) and search.beats(rest, model):
        return True
    less = search.fitted(model.fitted.candidate.without([name]))
    return taken(less, model) < MOST_OF_IT * taken(less, rest)


def _alone(analysis: Analysis, unknown: Scored, names: tuple[str, ...]) -> Scored:
    """Return a free law without names that it makes needless, as it was fitted in the first step or fitted anew."""
    law = set(unknown.names) - set(names)
    fitted = (one for one in analysis.search.steps[0].unknown if set(one.names) == law)
    return next(fitted, None) or analysis.search.fitted(unknown.fitted.candidate.without(names))
