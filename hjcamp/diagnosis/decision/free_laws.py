"""Names held against the free laws that were found where they were."""

from __future__ import annotations

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.diagnosis.selection.scored import Scored


def simpler(analysis: Analysis, free: Scored, model: Scored, names: tuple[str, ...]) -> bool:
    """Whether one free law is the simpler explanation: as good as the names with no more parameters, or than several as one thing.

    One that is another form of a name is that same thing.
    """
    search = analysis.search
    if search.beats(model, free):
        return False
    if len(free.fitted.free) <= len(model.fitted.free):
        return True
    return len(names) > 1 and free.left_out <= model.left_out and not _forms(search, free, names)


def forms_of(analysis: Analysis, free: Scored, model: Scored, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return those of several names of which a free law is another form that by itself leaves no more than all of them; else none.

    What was found first decides nothing: the rest only mends the form of these.
    """
    forms = _forms(analysis.search, free, names)
    return forms if 0 < len(forms) < len(names) and free.left_out <= model.left_out else ()


def further_law(analysis: Analysis, model: Scored, unknown: Scored | None) -> tuple[Scored, Scored] | None:
    """Return the model of the first names with a free law in the place of those that were found after them; none where none is better.

    It is no form of these, and predicts better than they do: beside the free law that stands beside them, where one does.
    """
    search, base = analysis.search, analysis.base
    for step in search.steps:
        later = model.beyond(step.before)
        if not step.before.beyond(base) or not later or not set(step.before.names) < set(model.names):
            continue
        for free in step.unknown:
            if _forms(search, free, later) or not search.matters(free, step.before, step.level_of_unknown):
                continue
            [law] = free.beyond(step.before)
            one = free
            if unknown is not None and law not in unknown.names and not search.beats(model, free):
                rest = unknown.fitted.candidate.without(later)
                one = search.fitted(rest.with_effect(law, free.fitted.candidate.effects[law]))
            if search.beats(one, unknown or model):
                return step.before, free
    return None


def _forms(search: Search, free: Scored, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of which the free law of a model is another form."""
    law: Unknown = next(search.unknowns[name] for name in free.names if name in search.unknowns)
    return tuple(name for name in names if equivalent_laws(law, search.library[name]))
