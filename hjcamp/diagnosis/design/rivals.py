"""The rivals that a proposed test is to separate: the models that the tests so far do not rule out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import left_of
from hjcamp.diagnosis.decision.verdict import CANNOT_TELL, EFFECT, NOTHING, ONE_OF
from hjcamp.diagnosis.design.draws import draws
from hjcamp.diagnosis.levels import DELTA
from hjcamp.diagnosis.screening.screening import Projection
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.candidate import Candidate

NONE = "nothing"
MOST = 4
MOST_FOUND = 3
MOST_HIDDEN = 6
DRAWS = 4
# An effect of its usual size that would stand out by so many standard deviations has been looked for.
SEEN = 3.0


@dataclass(frozen=True)
class Rival:
    """One explanation: its effects (none: nothing is missing), its model, and what the tests allow of its parameters.

    ``fitted`` is false for an effect at its usual size that the tests could not have shown: ``model`` is then the one without it.
    """

    names: tuple[str, ...]
    model: Scored
    candidate: Candidate
    draws: tuple[Candidate, ...]
    fitted: bool = True

    @property
    def name(self) -> str:
        """How it is called in tables and pictures."""
        return " + ".join(self.names) or NONE


@dataclass(frozen=True)
class Question:
    """What is to be distinguished: rivals, and ordered pairs of them (true, other): each true one against a refit of the other."""

    rivals: tuple[Rival, ...]
    contests: tuple[tuple[int, int], ...]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """The pairs of rivals, whichever of the two is true."""
        return sorted({(min(one), max(one)) for one in self.contests})


def question_of(
    analysis: Analysis, answer: Mapping[str, Any], known: Sequence[Scored], names: Sequence[str] = (), seed: int = 1
) -> Question:
    """Return the rivals that a diagnosis leaves, or those of these names, the likeliest first; few or none where it leaves none.

    ``answer`` is that of the diagnosis, by the keys of ``hjcamp.diagnosis/2``; ``known`` are models that are fitted already.
    Raises ``UsageError`` for a name that the library has not.
    """
    sets: list[tuple[str, ...]] = []
    for name in names:
        if name in analysis.base.names:
            raise UsageError(f"--rivals {name}: the model that the tests are explained with has it already")
    if names:
        sets = [() if name == NONE else (name,) for name in check_names(analysis.search.library, names)]
    elif answer["verdict"] != NOTHING:
        sets = sets_of(answer)
    if not sets and answer["verdict"] in (NOTHING, CANNOT_TELL):
        return _hidden(analysis, seed)
    values = {row["effect"]: {key: one["value"] for key, one in row["parameters"].items()} for row in answer["candidates"]}
    found = {name for one in sets for name in one}
    analysis.search.admit({name: law for name, law in analysis.search.values().items() if name in found})
    models = [_model_with(analysis, known, one, values) for one in sets]
    rivals = [
        Rival(names_of, one, one.fitted.candidate, tuple(draws(analysis, one, DRAWS, seed)))
        for names_of, one in zip(sets, models, strict=True)
        if np.isfinite(one.fitted.loss)
    ]
    return Question(tuple(rivals), tuple(permutations(range(len(rivals)), 2)))


def sets_of(answer: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the sets of names that a diagnosis does not rule out; what it names and the best others where it is sure.

    Where it cannot tell: nothing, and the effects that take a share that matters; none where no effect does.
    """
    named = [tuple(one) for one in answer["confidence_set"]]
    others: list[tuple[str, ...]] = [(row["effect"],) for row in answer["candidates"] if row["effect"] not in answer["effects"]]
    if answer["verdict"] == CANNOT_TELL:
        rows = sorted(answer["candidates"], key=left_of)
        able = [(row["effect"],) for row in rows if left_of(row) <= 1.0 - DELTA]
        return [(), *able][:MOST_FOUND] if able else []
    if answer["verdict"] == ONE_OF:
        return named[:MOST]
    if answer["verdict"] == EFFECT:
        return [tuple(answer["effects"]), *others][:MOST_FOUND]
    laws = ((row["law"],) for row in answer["unknowns"])
    return list(dict.fromkeys(one for one in (*named, *laws, *others) if one))[:MOST_FOUND]


def check_names(library: Mapping[str, Any], names: Sequence[str]) -> list[str]:
    """Return the names of two rivals or more; one alone stands against "nothing". Raises ``UsageError``."""
    for name in names:
        if name not in library and name != NONE:
            raise unknown("rival", name, [*library, NONE])
    if len(set(names)) < len(names):
        raise UsageError(f"--rivals {','.join(names)}: name each rival once")
    if list(names) == [NONE]:
        raise UsageError(f"--rivals {NONE}: name an effect as well")
    if len(names) > MOST:
        raise UsageError(f"--rivals: {len(names)} rivals; name at most {MOST}")
    return [*names, NONE] if len(names) == 1 else list(names)


def _model_with(
    analysis: Analysis, known: Sequence[Scored], names: Sequence[str], values: Mapping[str, Mapping[str, float]]
) -> Scored:
    """Return the calibrated model with these effects or unknowns, fitted from ``values`` where that has not been done."""
    base = analysis.base
    for one in (base, *known):
        if set(one.beyond(base)) == set(names):
            return one
    if all(name in values for name in names):
        place, analysis.windows.place = analysis.windows.place, base.place
        start = base.fitted.candidate
        for name in names:
            start = start.with_effect(name, {**analysis.search.library[name].defaults(), **values[name]})
        begun = analysis.search.best_of([start], base.fitted)
        found = analysis.search.fitted(begun.candidate, begun)
        analysis.windows.place = place
        return found
    model = base
    for name in names:
        model = _added(analysis, model, name)
    return model


def _added(analysis: Analysis, model: Scored, name: str) -> Scored:
    """Return the fit of a model with one effect more, from where it promises most."""
    search, windows = analysis.search, analysis.windows
    place, windows.place = windows.place, model.place
    fitted, projection = model.fitted, Projection(model.fitted)
    if name in search.unknowns:
        [probe] = search.probes(fitted, name)
        begun = search.begun_unknown(fitted, projection.promise(probe, search.unknowns[name].effect))
    else:
        effect, probes = search.library[name], search.probes(fitted, name)
        begun = search.begun(projection, name, [projection.promise(probe, effect) for probe in probes])
    found = search.fitted(begun.candidate, begun)
    windows.place = place
    return found


def _hidden(analysis: Analysis, seed: int) -> Question:
    """Return "nothing" and the effects that would not stand out in these tests at their usual size, the least visible last."""
    search, base = analysis.search, analysis.base
    windows, projection = analysis.windows, Projection(base.fitted)
    place, windows.place = windows.place, base.place
    found: list[tuple[float, str, Candidate]] = []
    for name, effect in search.library.items():
        if name in base.names:
            continue
        probe = next(iter(search.probes(base.fitted, name)), None)
        if probe is None:
            continue
        seen = float(np.linalg.norm(projection.free_of_base(probe.responses)))
        if seen < SEEN:
            values = {
                **probe.setting,
                probe.amplitudes[0]: (effect.parameters[probe.amplitudes[0]].off or 0.0) + probe.sizes[0],
            }
            found.append((seen, name, base.fitted.candidate.with_effect(name, values)))
    windows.place = place
    found.sort(key=lambda one: -one[0])
    rivals = [Rival((), base, base.fitted.candidate, tuple(draws(analysis, base, DRAWS, seed)))]
    rivals += [Rival((name,), base, one, (one,), fitted=False) for _, name, one in found[:MOST_HIDDEN]]
    return Question(tuple(rivals), tuple((k, 0) for k in range(1, len(rivals))))
