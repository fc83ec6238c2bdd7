"""Which models the tests do not rule out beside the one that was found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws
from hjcamp.diagnosis.levels import MATTERS, MOST_OF_IT
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.model.declare.candidate import Candidate


def taken(base: Scored, model: Scored) -> float:
    """Return the logarithm of the factor by which a model makes the error of left-out blocks smaller."""
    return math.log(base.left_out / model.left_out)


def confidence_set(analysis: Analysis, model: Scored, added: tuple[str, ...], unknown: Scored | None) -> list[Scored]:
    """Return the model and every model with one name exchanged that is not worse at the level of all claims.

    Where a free law takes a share that matters beside the model, rivals are compared beside it: what it takes is no scatter. Where it
    is another form of a name, and of a rival that takes most of what it takes, the two are compared beside it alone: of two
    wrong forms the nearer one is not thereby the kind. A rival of which it is no form is held against it.
    """
    search, found = analysis.search, [model]
    best = unknown or model
    laws = {name: own for name, own in best.fitted.candidate.effects.items() if name not in model.names}
    free = [search.unknowns[name] for name in laws if name in search.unknowns]
    for step in search.steps:
        here = [name for name in added if any(name in one.names for one in step.named) and name not in step.before.names]
        for one in step.named:
            [other] = one.beyond(step.before)
            for name in here:
                # what takes less than matters is no rival; another law of the same driver is judged beside the other names alone
                if other in model.names or one.left_out >= step.before.left_out:
                    continue
                beside = len(added) > 1 and other in search.of_same_law(name, model)
                takes = beside or search.error_ratio(one, step.before) <= 1.0 - MATTERS
                takes = takes and not search.of_no_memory(one, step.before)
                formless = any(all(equivalent_laws(law, search.library[each]) for each in (name, other)) for law in free)
                formless = formless and taken(step.before, one) >= MOST_OF_IT * taken(step.before, best)
                # a free law that is another form of the name, and none of the rival, predicts better than that
                strange = len(added) == 1 and any(
                    equivalent_laws(law, search.library[name]) and not equivalent_laws(law, search.library[other])
                    for law in free
                )
                own = _of(step, name)
                # that a free law rules a rival out does not speak for a name that leaves no less than the rival
                gone = ruled_out(analysis, one, best if strange and search.beats(own, one) else own, step.before)
                if not takes or (not beside and not formless and gone):
                    continue
                values = {other: one.fitted.candidate.effects[other], **laws}
                rival = search.fitted(_with(model.fitted.candidate.without([name]), values))
                if set(one.names) == set(rival.names):
                    rival = min(one, rival, key=lambda each: each.left_out)
                known = {frozenset(each.names) for each in found}
                if frozenset(rival.names) not in known and not ruled_out(analysis, rival, best, step.before):
                    found.append(rival)
    return [*found, *_of_lags(analysis, found, best, laws)]


def _of_lags(
    analysis: Analysis, found: Sequence[Scored], best: Scored, laws: Mapping[str, Mapping[str, float]]
) -> list[Scored]:
    """Return the models that are not ruled out in which another lag stands in the place of one, beside what else a model has.

    No step saw one behind what bends a command before the bend was there.
    """
    search, base = analysis.search, analysis.base
    named = [tuple(name for name in model.beyond(base) if name in search.library) for model in found]
    known, rivals = {frozenset(names) for names in named}, []
    for model, names in zip(found, named, strict=True):
        lags = [(one, other) for one in names for other in search.other_lags(one, model)] if len(names) > 1 else []
        for name, other in lags:
            own = frozenset(names) - {name} | {other}
            if own in known:
                continue
            known.add(own)
            rival = search.fitted(_with(search.in_place(name, other, model), laws))
            if not ruled_out(analysis, rival, best, base):
                rivals.append(rival)
    return rivals


def _with(candidate: Candidate, effects: Mapping[str, Mapping[str, float]]) -> Candidate:
    """Return a candidate with effects, or free laws, by their values."""
    for name, own in effects.items():
        candidate = candidate.with_effect(name, own)
    return candidate


def ruled_out(analysis: Analysis, rival: Scored, model: Scored, before: Scored) -> bool:
    """Whether a model rules a rival out, as it does one that diverges; one that takes most of what it takes is fitted to the end first.

    What has a memory follows the starts of its windows slowly: after few turns it loses to what has none.
    """
    search = analysis.search
    if not math.isfinite(rival.left_out):
        return True
    if not search.ruled_out(rival, model):
        return False
    return taken(before, rival) < MOST_OF_IT * taken(before, model) or search.ruled_out(search.to_the_end(rival), model)


def _of(step: Step, name: str) -> Scored:
    return next(one for one in step.named if name in one.names)
