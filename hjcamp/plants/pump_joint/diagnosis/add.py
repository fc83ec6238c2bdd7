"""Add effects to a model: fit them with the base parameters on part of the tests, judge on the others."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.fitting.calibrate import calibrate
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Fold, Local, folds, parameter_rows
from hjcamp.plants.pump_joint.diagnosis.fitting.pattern_search import settle
from hjcamp.plants.pump_joint.diagnosis.models.saved import complete
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.scale import Judge, Judged, Scale, fall_of, scale_of
from hjcamp.plants.pump_joint.diagnosis.screening.screening import fit_effect, screen, unknowns_of

SCHEMA = "hjcamp.addition/1"
SWEEPS = 6


@dataclass(frozen=True)
class Addition:
    """The new model, its fit on the train tests, and the held-out errors: start, calibrated, new.

    ``fall`` is by how much the error of single tests falls from calibrated to new, in floors, and the standard error of
    that: more is needed for it to help.
    """

    candidate: Candidate
    fit: Fit
    fold: Fold
    scale: Scale
    start: Judged
    before: Judged
    after: Judged
    fall: tuple[float, float]
    calibration: dict[str, dict[str, Any]]
    effects: dict[str, dict[str, dict[str, Any]]]

    @property
    def helps(self) -> bool:
        """Whether the error on tests that were not used for the fit falls by more than its standard error."""
        return self.fall[0] > self.fall[1]


def check_effects(names: Sequence[str], library: Mapping[str, type[Effect]], start: Candidate, model: str) -> None:
    """Refuse unknown effects, names given twice, and effects that the start model has already."""
    for name in names:
        if name not in library:
            raise unknown("effect", name, library)
        if names.count(name) > 1:
            raise UsageError(f"effect {name} is named twice")
        if name in start.effects:
            raise UsageError(f"effect {name} is in model {model} already")


def add(views: Views, start: Candidate, names: Sequence[str], steps: int = 8, sweeps: int = SWEEPS) -> Addition:
    """Return ``start`` with the effects ``names``, fitted with the base on all repetitions but the last of each condition.

    The effects of ``start`` stay and are fitted again too. Effects are tried in every order (up to three of them) and
    the best fit is kept. A pattern search of ``sweeps`` settles it, and what it is compared with.
    """
    evidence = views.evidence
    features = Features(evidence)
    parts = folds(evidence, 1)
    fold = parts[0] if parts else Fold(tuple(range(len(evidence.tests))), tuple(range(len(evidence.tests))))
    base, whole = calibrate(views, features)
    fitter = Fitter(views, features, whole.least, fold.train)
    begin = complete(start, evidence)
    unknowns = unknowns_of(start, views.effects)
    starts = [begin, Candidate(base.candidate.base, start.effects)]
    before = min((fitter.fit(one, unknowns, steps=steps) for one in starts), key=lambda fit: fit.loss)
    before = settle(fitter, before, unknowns, sweeps)
    orders = list(itertools.permutations(names)) if len(names) <= 3 else [tuple(names)]
    best = min((_in_order(fitter, before, order, views.effects, steps) for order in orders), key=lambda fit: fit.loss)
    unknowns = unknowns_of(best.candidate, views.effects)
    best = settle(fitter, best, unknowns, sweeps)
    found = Local(fitter, best, unknowns).intervals()
    scale = scale_of(views, base.candidate)
    judge = Judge(views, [fold], scale)
    errors = [judge.of([one]) for one in (begin, before.candidate, best.candidate)]
    fall = fall_of(errors[1], errors[2])
    published = begin.base
    calibration = {name: {"start": published[name], **row} for name, row in parameter_rows(found, unknowns, "").items()}
    effects = {name: parameter_rows(found, unknowns, name) for name in best.candidate.effects}
    return Addition(best.candidate, best, fold, scale, errors[0], errors[1], errors[2], fall, calibration, effects)


def _in_order(fitter: Fitter, fit: Fit, names: Sequence[str], effects: Sequence[type[Effect]], steps: int) -> Fit:
    for name in names:
        effect = next(one for one in effects if one.name == name)
        screening = screen(fitter, fit, [one for one in effects if one.name in fit.candidate.effects or one is effect])
        if name in screening.ranked:
            fit = fit_effect(fitter, screening, effect, effects, steps)
        else:
            # These tests do not show it at all: it joins at its smallest amplitude and the fit decides.
            joined = fit.candidate.with_effect(name, effect.defaults())
            fit = fitter.fit(joined, unknowns_of(joined, effects), steps=steps)
    return fit


def answer(addition: Addition, name: str, names: Sequence[str], path: str) -> dict[str, Any]:
    """Return the answer for programs, schema hjcamp.addition/1: errors on held-out tests, on the scale of `compare`."""
    told = {"start": addition.start, "before": addition.before, "after": addition.after}
    return {
        "schema": SCHEMA,
        "model": name,
        "file": path,
        "effects": list(names),
        "helps": addition.helps,
        "fall": {
            name: value if math.isfinite(value) else None
            for name, value in zip(("mean", "standard_error"), addition.fall, strict=True)
        },
        "error": {
            **{name: one.score if math.isfinite(one.score) else None for name, one in told.items()},
            "floor": 1.0 if addition.scale.repeated else None,
        },
        "channels": {
            channel: {
                **{name: error.rms if (error := one.errors[channel]) else None for name, one in told.items()},
                "floor": noise_floor,
            }
            for channel, noise_floor in addition.scale.noise_floors.items()
        },
        "tests": {"fitted": len(addition.fold.train), "held_out": len(addition.fold.held_out)},
        "parameters": addition.effects,
        "calibration": addition.calibration,
    }
