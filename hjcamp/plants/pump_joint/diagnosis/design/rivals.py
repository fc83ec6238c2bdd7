"""The rivals that a proposed test is to separate: what a diagnosis could not tell apart, or effects by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step, fit_effect

NOTHING = "nothing"
MOST = 4
MOST_NAMED = 6
LEAST_WEIGHT = 0.02
STEPS = 8


@dataclass(frozen=True)
class Rival:
    """One explanation: its effects (none: nothing is missing), the model with all parameters, and its posterior."""

    effects: tuple[str, ...]
    candidate: Candidate
    posterior: float

    @property
    def name(self) -> str:
        """How it is called in tables and pictures."""
        return " + ".join(self.effects) or NOTHING


def check_names(names: Sequence[str], library: Mapping[str, type[Effect]]) -> list[str]:
    """Return the names of two or more rivals; one alone stands against "nothing". Unknown and double ones are refused."""
    for name in names:
        if name not in library and name != NOTHING:
            raise unknown("rival", name, [*library, NOTHING])
    if len(set(names)) < len(names):
        raise UsageError(f"--rivals {','.join(names)}: name each rival once")
    if len(names) > MOST_NAMED:
        raise UsageError(f"--rivals: {len(names)} rivals; name at most {MOST_NAMED}, or none to set all apart from nothing")
    if list(names) == [NOTHING]:
        raise UsageError(f"--rivals {NOTHING}: name an effect as well")
    return [*names, NOTHING] if len(names) == 1 else list(names)


def rivals_by_name(names: Sequence[str], library: Mapping[str, type[Effect]], values: Mapping[str, float]) -> list[Rival]:
    """Return "nothing" or effects at their default amplitudes on the plant with ``values``, all alike likely."""
    base = {one.name: values.get(one.name, PumpJoint.parameters[one.name].default) for one in base_unknowns()}
    rivals = []
    for name in names:
        effects = {} if name == NOTHING else {name: library[name].defaults()}
        rivals.append(Rival(tuple(effects), Candidate(base, effects), 1.0 / len(names)))
    return rivals


def rivals_of(found: Diagnosis, library: Mapping[str, type[Effect]], names: Sequence[str] = ()) -> list[Rival]:
    """Return the rivals that a diagnosis leaves, likeliest first; none where its verdict is settled.

    Too few tests leave every effect, at its default amplitude on the calibrated base, against nothing. With ``names``
    those are the rivals, whatever the verdict: fitted here where the diagnosis has not fitted them.
    """
    if not found.steps and (names or found.verdict == "cannot_tell"):
        return rivals_by_name(names or [NOTHING, *library], library, found.baseline.candidate.base)
    if names:
        return _normalised([_named(found, library, name) for name in names])
    if not found.undecided:
        return []
    step = next(one for one in found.steps if set(found.undecided) <= set(one.fits))
    return _normalised([_fitted(found, step, name) for name in found.undecided[:MOST]])


def _fitted(found: Diagnosis, step: Step, name: str) -> Rival:
    """Return one fit of a step, with the effects that later steps have found beside the step's best."""
    candidate = step.fits[name].candidate
    best = step.fits[step.best].candidate
    for other, parameters in found.final.candidate.effects.items():
        if other not in best.effects and other not in candidate.effects:
            candidate = candidate.with_effect(other, parameters)
    return Rival((name,), candidate, step.weights[name])


def _named(found: Diagnosis, library: Mapping[str, type[Effect]], name: str) -> Rival:
    if name == NOTHING:
        return Rival((), found.baseline.candidate, LEAST_WEIGHT)
    for step in found.steps:
        if name in step.fits:
            return _fitted(found, step, name)
    screening = found.steps[0].screening
    if name not in screening.ranked:
        raise UsageError(f"{name} cannot be fitted to these tests: it is not visible in them")
    fit = fit_effect(found.fitter, screening, library[name], tuple(library.values()), STEPS)
    return Rival((name,), fit.candidate, LEAST_WEIGHT)


def _normalised(rivals: Sequence[Rival]) -> list[Rival]:
    total = sum(max(rival.posterior, LEAST_WEIGHT) for rival in rivals)
    shares = [Rival(one.effects, one.candidate, max(one.posterior, LEAST_WEIGHT) / total) for one in rivals]
    return sorted(shares, key=lambda rival: -rival.posterior)
