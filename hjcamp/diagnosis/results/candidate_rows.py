"""Rows of an answer that stand for candidates: named effects, and non-parametric terms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.decision.effect_size import functional
from hjcamp.diagnosis.decision.free_curve import curve_of, knots_of
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.estimation.intervals import Interval, intervals
from hjcamp.diagnosis.results.shares import left_above, rms_ratio
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.diagnosis.validation.blocks import advantages, chance_of_t, critical


def candidates(analysis: Analysis, verdict: Verdict) -> list[dict[str, Any]]:
    """Return every named effect that was fitted, those of the model first, then by how well they did in the last look."""
    search, base = analysis.search, analysis.base
    rows, seen = [], set()
    for model in (verdict.model, *verdict.rivals):
        own = [name for name in model.beyond(base) if name in search.library and name not in seen]
        # beside a free law a rival was compared with the model beside the same law, which its row has no part of
        laws = [name for name in model.names if name in search.unknowns] if own and model is not verdict.model else []
        model = _without(analysis, model, laws) if laws else model
        for name in own:
            seen.add(name)
            without = next(step for step in search.steps if name not in step.before.names)
            rows.append(_candidate(analysis, verdict, name, model, without, named=name in verdict.effects))
    # what was fitted beside a free law alone says nothing of what it does by itself
    for step in (one for one in search.steps if not any(name in search.unknowns for name in one.before.names)):
        for one in step.named:
            [name] = one.beyond(step.before)
            if name not in seen:
                seen.add(name)
                rows.append(_candidate(analysis, verdict, name, one, step, named=name in verdict.effects))
    return rows


def _without(analysis: Analysis, model: Scored, laws: Sequence[str]) -> Scored:
    """Return a model without non-parametric terms, as a look fitted it, or fitted from what it has in addition to them."""
    search, names = analysis.search, set(model.names) - set(laws)
    known = (one for step in search.steps for one in step.named if set(one.names) == names)
    return next(known, None) or search.fitted(model.fitted.candidate.without(laws), model.fitted)


def asked_candidates(analysis: Analysis, verdict: Verdict, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return rows for effects that were asked for and were not fitted yet: each in addition to the calibrated model alone."""
    known = {row["effect"] for row in candidates(analysis, verdict)} | set(analysis.base.names)
    rows, alone = [], next(iter(analysis.search.steps), None) or Step(analysis.base, 1.0, np.zeros(0), 0.0, (), ())
    for name in dict.fromkeys(names):
        if name in known:
            continue
        effect = analysis.search.library[name]
        model = analysis.search.fitted(analysis.base.fitted.candidate.with_effect(name, effect.defaults()))
        if np.isfinite(model.left_out):
            rows.append(_candidate(analysis, verdict, name, model, alone, named=False))
    return rows


def _candidate(analysis: Analysis, verdict: Verdict, name: str, model: Scored, step: Step, named: bool) -> dict[str, Any]:
    effect = analysis.search.library[name]
    found = [one for one in intervals(model.fitted, analysis.search.blocks) if one.effect == name]
    t, count = analysis.search.t(model, step.before)
    weight = _weight(t, count) if not named else 1.0
    parameters = {one.name: _row(one, effect.parameters[one.name].unit) for one in found}
    return {
        "effect": name,
        "beside": list(step.before.beyond(analysis.base)),
        "posterior": weight,
        "t": float(np.clip(t, -1e3, 1e3)),
        "t_needed": critical(count, step.level),
        "heldout_error_ratio": rms_ratio(analysis, model, step.before),
        "left_above_repeatability": left_above(analysis, model, step.before),
        "p_value": chance_of_t(t, count),
        "law_left": _law_left(analysis, verdict, model),
        "parameters": parameters,
        "functional": functional(analysis, name, model, parameters),
    }


def _law_left(analysis: Analysis, verdict: Verdict, model: Scored) -> float | None:
    """Return the share that a model leaves of the logarithm by which the best model, an unknown too, makes the error smaller.

    None where the best model is the base: there is nothing to take.
    """
    best = min([verdict.model, *([verdict.unknown] if verdict.unknown else [])], key=lambda one: one.left_out)
    most, taken = (float(np.log(analysis.base.left_out / one.left_out)) for one in (best, model))
    return float(np.clip(1.0 - taken / most, 0.0, 1.0)) if most > 0.0 else None


def _weight(t: float, blocks: float) -> float:
    """Return the probability of Student's t below the comparison: 0 where a model is clearly no better than without."""
    return max(0.0, 1.0 - 2.0 * chance_of_t(t, blocks))


def _row(one: Interval, unit: str) -> dict[str, Any]:
    return {"value": one.value, "unit": unit, **one.row, "at_bound": one.at_bound}


def drivers_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what drives the unknowns that the first of `unknown_rows` does not rule out, each once, the most likely first."""
    return list(dict.fromkeys(row["driver"] for row in rows if not row["ruled_out"]))


def unknown_rows(analysis: Analysis, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the unknowns that were fitted last, best first, and whether the first, which has its curve, rules out each other one."""
    search = analysis.search
    if verdict.unknown is None:
        return []
    step = next((step for step in reversed(search.steps) if verdict.unknown in step.unknown), None)
    ordered: Sequence[Scored] = [
        verdict.unknown,
        *(one for one in (step.unknown if step else ()) if one is not verdict.unknown),
    ]
    rows = []
    for place, one in enumerate(ordered):
        [name] = [each for each in one.names if each in search.unknowns]
        known = search.unknowns[name]
        reference = step.before if step else analysis.base
        row = {
            "driver": known.driven_by,
            "law": name,
            "quantity": known.quantity,
            "port": known.place,
            "signal": known.signal,
            "slots": list(known.effect.terms),
            "apart_s": known.apart,
            "gain": float(advantages(one.features, reference.features, search.blocks).sum()),
            "ruled_out": place > 0 and not (search.matters(one, reference) and not search.ruled_out(one, verdict.unknown)),
        }
        if place == 0:
            row["left"] = rms_ratio(analysis, one, analysis.base)
            row["left_above_repeatability"] = left_above(analysis, one, analysis.base)
            row["curve"] = curve_of(analysis, one, name)
            row["knots"] = knots_of(analysis, one, name)
        rows.append(row)
    return rows
