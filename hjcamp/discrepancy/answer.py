"""The answer of a diagnosis for programs: schema hjcamp.diagnosis/1."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.diagnose import Diagnosis
from hjcamp.discrepancy.fit import Fit
from hjcamp.discrepancy.heldout import Fold, Local, folds, judged_error, parameter_rows
from hjcamp.discrepancy.saved import complete
from hjcamp.discrepancy.search import Step, unknowns_of
from hjcamp.discrepancy.unknowns import base_unknowns
from hjcamp.discrepancy.where import Place, where
from hjcamp.model.effect import Effect

SCHEMA = "hjcamp.diagnosis/1"
FOLDS = {"quick": 1, "standard": 3, "thorough": 3}
NOTHING_ELSE = 0.5
SHOWN = {"quick": 3, "standard": 5, "thorough": 10}
Report = Callable[[str, float], None]


def places_of(found: Diagnosis, fit: Fit) -> list[Place]:
    """Return where the error of one fit is; its views follow the measured pump, so the pump's own model has no share."""
    return where(found.features, fit.features, found.features.floor(fit.features), None)


def answer(
    found: Diagnosis,
    effects: Sequence[type[Effect]],
    effort: str,
    seconds: float,
    report: Report = lambda text, share: None,
) -> dict[str, Any]:
    """Return every key of the contract; ``seconds`` is what passed before, the time of this is added by the caller."""
    views, fitter = found.fitter.views, found.fitter
    parts = folds(views.evidence, FOLDS[effort])
    base, final = found.baseline, found.final
    report("judging on tests not used for the fit", 0.96)
    start = Local(fitter, base, unknowns_of(base.candidate, effects))
    baseline = start.heldout_error(parts, found.floor)
    best, augmented = start, baseline
    if final.candidate.effects != base.candidate.effects:
        best = Local(fitter, final, unknowns_of(final.candidate, effects))
        augmented = best.heldout_error(parts, found.floor)
    places = places_of(found, base)
    report("intervals", 0.98)
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "effects": list(found.effects),
        "drivers": list(found.drivers) if found.verdict == "outside_library" else [],
        "p_value": float(found.p_value),
        "candidates": _candidates(found, effects, effort, baseline, best, parts),
        "error": {"baseline": _finite(baseline), "augmented": _finite(augmented), "floor": 1.0},
        "calibration": _calibration(best),
        "where": [place.row() for place in places],
        "confounded": found.confounded,
        "minimum_detectable": _detectable(found),
        "seconds": seconds,
    }


def start_error(found: Diagnosis, start: Candidate, effort: str) -> float | None:
    """Return the error over the floor of the model before it was calibrated, on the tests that judge the others."""
    fitter = found.fitter
    evidence = fitter.views.evidence
    seen = fitter.look(complete(start, evidence)).mean_square
    errors = [
        judged_error(fitter.features, seen, found.floor, fold.held_out) for fold in folds(evidence, FOLDS[effort])
    ]
    return math.sqrt(sum(one**2 for one in errors) / len(errors)) if errors else None


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


def _candidates(
    found: Diagnosis, effects: Sequence[type[Effect]], effort: str, baseline: float, best: Local, parts: Sequence[Fold]
) -> list[dict[str, Any]]:
    """Return the effects named first, then the rivals of the last step by weight; each fitted effect once."""
    rows: dict[str, tuple[Step, float, int]] = {}
    for step in found.steps:
        taken = step in found.taken
        for name, weight in step.weights.items():
            # Where no effect was taken, "nothing" is the strongest rival of all: at least as likely as all of them.
            posterior = weight if taken else NOTHING_ELSE * weight * (1.0 - step.p_value)
            first = 0 if taken and name == step.best else 1
            if name not in rows or (first, -posterior) < (rows[name][2], -rows[name][1]):
                rows[name] = (step, posterior, first)
    order = sorted(rows, key=lambda name: (rows[name][2], -rows[name][1]))[: SHOWN[effort] + len(found.effects)]
    answers = []
    for name in order:
        step, posterior, _ = rows[name]
        fit = step.fits[name]
        own = best if fit is best.fit else Local(found.fitter, fit, unknowns_of(fit.candidate, effects))
        error = own.heldout_error(parts, found.floor)
        final = best if name in best.fit.candidate.effects else own
        parameters = parameter_rows(final.intervals(), final.unknowns, name)
        ratio = _finite(error / baseline) if baseline > 0 else None
        answers.append(
            {"effect": name, "posterior": float(posterior), "heldout_error_ratio": ratio, "parameters": parameters}
        )
    return answers
