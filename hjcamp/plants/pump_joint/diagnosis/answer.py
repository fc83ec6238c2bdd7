"""The answer of a diagnosis for programs: schema hjcamp.diagnosis/2."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.answer_rows import (
    confidence_set,
    functional,
    law_left,
    law_left_of,
    noise_floor_rows,
    rests_on,
    worst,
)
from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Local, folds, parameter_rows
from hjcamp.plants.pump_joint.diagnosis.localisation.where import Place, where
from hjcamp.plants.pump_joint.diagnosis.models.saved import complete
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns
from hjcamp.plants.pump_joint.diagnosis.scale import Judge, Judged, scale_of
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step, fit_effect, rival_weights, unknowns_of

SCHEMA = "hjcamp.diagnosis/2"
FOLDS = {"quick": 1, "standard": 3, "thorough": 3}
NOTHING_ELSE = 0.5
STEPS_ASKED = 4
SHOWN = {"quick": 3, "standard": 5, "thorough": 10}
Report = Callable[[str, float], None]


class Judging:
    """The fits of a diagnosis judged on tests that were not used for them, on the scale of `compare`."""

    def __init__(self, found: Diagnosis, effects: Sequence[type[Effect]], effort: str) -> None:
        self.found, self.effects = found, tuple(effects)
        views = found.fitter.views
        self.parts = folds(views.evidence, FOLDS[effort])
        self.scale = scale_of(views, found.reference)
        self._judge = Judge(views, self.parts, self.scale)

    def of(self, local: Local) -> Judged:
        """Return the errors of a fit, made again without what judges it."""
        return self._judge.of(local.without(self.parts))

    def of_start(self, start: Candidate) -> Judged:
        """Return the errors of a model before it was calibrated, on the same tests."""
        return self._judge.of([complete(start, self.found.fitter.views.evidence)] * len(self.parts))

    @cached_property
    def base(self) -> Local:
        """The calibrated model."""
        return self.local(self.found.baseline)

    @cached_property
    def best(self) -> Local:
        """The model with the effects; the calibrated one where it has none more."""
        same = self.found.final.candidate.effects == self.found.baseline.candidate.effects
        return self.base if same else self.local(self.found.final)

    @cached_property
    def before(self) -> Judged:
        """The errors of the calibrated model."""
        return self.of(self.base)

    @cached_property
    def after(self) -> Judged:
        """The errors of the model with the effects."""
        return self.before if self.best is self.base else self.of(self.best)

    def local(self, fit: Fit) -> Local:
        """Return a fit with what its errors and intervals need."""
        known = [one.jacobian for one in self.found.screenings if one.about is fit]
        return Local(self.found.fitter, fit, unknowns_of(fit.candidate, self.effects), known[0] if known else None)

    def places(self, fit: Fit) -> list[Place]:
        """Return where the error of one fit is; its views follow the measured pump, so the pump's own model has no share."""
        return where(self.found.features, fit.features, self.scale.features, None)


def answer(
    found: Diagnosis,
    effects: Sequence[type[Effect]],
    effort: str,
    seconds: float,
    report: Report = lambda text, share: None,
    judging: Judging | None = None,
) -> dict[str, Any]:
    """Return every key of the contract; ``seconds`` is what passed before, the time of this is added by the caller.

    Errors are those of `compare`: the geometric mean over arm and lines of the error over the floor (over the spread of
    the measurement where nothing was repeated, and the floor is None). ``heldout_error_ratio`` is of all residuals, forces
    and windows too, over those of the calibrated model: what ranks effects.
    """
    report("judging on tests not used for the fit", 0.96)
    judged = judging or Judging(found, effects, effort)
    error = {"baseline": _finite(judged.before.score), "augmented": _finite(judged.after.score)}
    places = judged.places(found.baseline)
    report("intervals", 0.98)
    return {
        "schema": SCHEMA,
        "plant": "pump_joint",
        "verdict": found.verdict,
        "effects": list(found.effects),
        "drivers": list(found.drivers) if found.verdict == "outside_library" else [],
        "lacking": list(found.lacking),
        "p_value": float(found.p_value),
        "candidates": _candidates(judged, SHOWN[effort]),
        "error": {**error, "floor": 1.0 if judged.scale.repeated else None},
        "calibration": _calibration(judged.best),
        "where": [place.row() for place in places],
        "confounded": found.confounded,
        "minimum_detectable": _detectable(found),
        "law_left": law_left_of(found),
        "confidence_set": confidence_set(found),
        "floor": noise_floor_rows(judged.scale, judged.before),
        "worst": worst(found.features.evidence, judged.scale, judged.after),
        "rests_on": rests_on(found.features.evidence),
        "seconds": seconds,
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _detectable(found: Diagnosis) -> dict[str, dict[str, Any]]:
    if found.verdict != "nothing_missing":
        return {}
    return {
        name: {"parameter": parameter, "value": float(value), "unit": unit}
        for name, (parameter, value, unit) in sorted(found.detectable.items())
    }


def _calibration(best: Local) -> dict[str, dict[str, Any]]:
    published = best.fitter.views.evidence.tests[0].hardware.values
    rows = parameter_rows(best.intervals(), best.unknowns, "")
    known = {one.name: one.parameter.default for one in base_unknowns()}
    return {name: {"published": float(published.get(name, known[name])), **row} for name, row in rows.items()}


def _candidates(judged: Judging, shown: int) -> list[dict[str, Any]]:
    """Return the effects named first, then the rivals of the last step by weight; each fitted effect once."""
    found = judged.found
    baseline = judged.base.heldout_error(judged.parts, found.noise_floor)
    rows: dict[str, tuple[Step, float, int]] = {}
    for step in found.steps:
        taken = step in found.taken
        for name, weight in step.weights.items():
            # Where no effect was taken, "nothing" is the strongest rival of all: at least as likely as all of them.
            posterior = weight if taken else NOTHING_ELSE * weight * (1.0 - step.p_value)
            first = 0 if taken and name == step.best else 1
            if name not in rows or (first, -posterior) < (rows[name][2], -rows[name][1]):
                rows[name] = (step, posterior, first)
    order = sorted(rows, key=lambda name: (rows[name][2], -rows[name][1]))[: shown + len(found.effects)]
    return [_candidate(judged, name, rows[name][0], rows[name][0].fits[name], rows[name][1], baseline) for name in order]


def _candidate(judged: Judging, name: str, step: Step | None, fit: Fit, posterior: float, baseline: float) -> dict[str, Any]:
    """Return the row of one effect: as it stands in the final model where it is in that, else as fitted beside others."""
    best = judged.best
    own = best if fit is best.fit else judged.local(fit)
    error = own.heldout_error(judged.parts, judged.found.noise_floor)
    final = best if name in best.fit.candidate.effects else own
    parameters = parameter_rows(final.intervals(), final.unknowns, name)
    ratio = _finite(error / baseline) if baseline > 0 else None
    chance = step.chance_of(name) if step is not None and name in step.fits else None
    return {
        "effect": name,
        "posterior": float(posterior),
        "heldout_error_ratio": ratio,
        "p_value": chance,
        "law_left": law_left(judged.found, final.fit),
        "parameters": parameters,
        "functional": functional(judged.found, name, final.fit, parameters),
    }


def asked_candidates(judged: Judging, names: Sequence[str], present: Sequence[str]) -> list[dict[str, Any]]:
    """Return rows for effects that were asked for and are not ``present``: fitted beside the calibrated model alone.

    Their weight is that beside the effects of the first step. None for an effect that the calibrated model has already.
    """
    found = judged.found
    baseline = judged.base.heldout_error(judged.parts, found.noise_floor)
    screening = found.screenings[0] if found.screenings else None
    rows = []
    for name in names:
        if screening is None or name in present or name not in {**screening.ranked, **screening.instead}:
            continue
        effect = next(one for one in judged.effects if one.name == name)
        fit = fit_effect(found.fitter, screening, effect, judged.effects, STEPS_ASKED)
        others = found.steps[0].fits if found.steps else {}
        weight = rival_weights({**others, name: fit}, found.fitter.least, judged.effects)[name]
        rows.append(_candidate(judged, name, None, fit, weight, baseline))
    return rows
