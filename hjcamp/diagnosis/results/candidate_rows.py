"""Rows of an answer that stand for candidates: named effects, and non-parametric terms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import left_above, rms_ratio
from hjcamp.diagnosis.decision.effect_size import functional
from hjcamp.diagnosis.decision.free_curve import curve_of, knots_of
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.estimation.intervals import Interval, intervals
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import advantages, chance_of_t, critical


def candidates(analysis: Analysis, verdict: Verdict) -> list[dict[str, Any]]:
    """Return every named effect that was fitted: those of the verdict first, with the model that has them, then what leaves least."""
    rows, seen, base = [], set(), analysis.base
    for model in (verdict.model, *verdict.rivals, *verdict.named):
        for name in model.beyond(base):
            if name in analysis.search.library and name not in seen:
                seen.add(name)
                rows.append(_candidate(analysis, verdict, name, model))
    return rows


def asked_candidates(analysis: Analysis, verdict: Verdict, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return rows for effects that were asked for and were not fitted yet: each in addition to the calibrated model alone."""
    known = {row["effect"] for row in candidates(analysis, verdict)} | set(analysis.base.names)
    rows, search = [], analysis.search.at(analysis.base.place)
    for name in dict.fromkeys(names):
        if name in known:
            continue
        model = search.fitted(analysis.base.fitted.candidate.with_effect(name, search.library[name].defaults()))
        if np.isfinite(model.left_out):
            rows.append(_candidate(analysis, verdict, name, model))
    return rows


def _candidate(analysis: Analysis, verdict: Verdict, name: str, model: Scored) -> dict[str, Any]:
    search, base = analysis.search, analysis.base
    effect, named = search.library[name], name in verdict.effects
    found = [one for one in intervals(model.fitted, search.blocks) if one.effect == name]
    t, count = search.t(model, base)
    parameters = {one.name: _row(one, effect.parameters[one.name].unit) for one in found}
    return {
        "effect": name,
        "beside": [one for one in model.beyond(base) if one != name],
        "posterior": 1.0 if named else _weight(t, count),
        "t": float(np.clip(t, -1e3, 1e3)),
        "t_needed": critical(count),
        "heldout_error_ratio": rms_ratio(analysis, model, base),
        "left_above_repeatability": left_above(analysis, model, base),
        "p_value": chance_of_t(t, count),
        "law_left": _law_left(analysis, verdict, model),
        "parameters": parameters,
        "functional": functional(analysis, name, model, parameters),
    }


def _law_left(analysis: Analysis, verdict: Verdict, model: Scored) -> float | None:
    """Return the share that a model leaves of the logarithm by which the best model, a non-parametric one too, makes the error smaller.

    None where the best model is the base: there is nothing to explain.
    """
    best = min((verdict.model, *verdict.named, *verdict.terms), key=lambda one: one.left_out)
    most, explained = (float(np.log(analysis.base.left_out / one.left_out)) for one in (best, model))
    return float(np.clip(1.0 - explained / most, 0.0, 1.0)) if most > 0.0 else None


def _weight(t: float, blocks: float) -> float:
    """Return the probability of Student's t below the comparison: 0 where a model is clearly no better than without."""
    return max(0.0, 1.0 - 2.0 * chance_of_t(t, blocks))


def _row(one: Interval, unit: str) -> dict[str, Any]:
    return {"value": one.value, "unit": unit, **one.row, "at_bound": one.at_bound}


def drivers_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what drives the unknowns that the first of `unknown_rows` does not rule out, each once, the most likely first."""
    return list(dict.fromkeys(row["driver"] for row in rows if not row["ruled_out"]))


def unknown_rows(analysis: Analysis, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the non-parametric terms that were fitted, that of the verdict first, which has its curve.

    Each says whether it is ruled out: by the first, or as it explains no share that matters.
    """
    search, base, channels = analysis.search, analysis.base, analysis.channels
    if verdict.term is None:
        return []
    rows = []
    for place, one in enumerate((verdict.term, *(one for one in verdict.terms if one is not verdict.term))):
        name = next(each for each in one.names if each in search.unknowns)
        known = search.unknowns[name]
        matters = channels.share(one.features, base.features, base.features) >= verdict.delta
        row = {
            "driver": known.driven_by,
            "law": name,
            "quantity": known.quantity,
            "port": known.place,
            "signal": known.signal,
            "slots": list(known.effect.terms),
            "apart_s": known.apart,
            "gain": float(advantages(one.features, base.features, search.blocks).sum()),
            "ruled_out": place > 0 and not (matters and not search.beats(verdict.term, one)),
        }
        if place == 0:
            row["left"] = rms_ratio(analysis, one, base)
            row["left_above_repeatability"] = left_above(analysis, one, base)
            row["curve"] = curve_of(analysis, one, name)
            row["knots"] = knots_of(analysis, one, name)
        rows.append(row)
    return rows
