"""The answer of a diagnosis for programs: the keys of ``hjcamp.diagnosis/2``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.repeatability import in_units, shared
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured, Sensor
from hjcamp.diagnosis.decision.by_condition import Differs
from hjcamp.diagnosis.decision.effect_size import functional
from hjcamp.diagnosis.decision.free_curve import curve_of, knots_of, mean_over_knots
from hjcamp.diagnosis.decision.given_constants import Constant
from hjcamp.diagnosis.decision.leading_regressors import leading
from hjcamp.diagnosis.decision.periodic_disturbance import Swing
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.estimation.intervals import Interval, intervals
from hjcamp.diagnosis.residuals.free_run import Whole, whole_error
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.results.shares import left_above, rms_ratio
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.diagnosis.validation.blocks import advantages, chance_of_t, critical
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.language.field_unit import unit_of_field

Array = NDArray[np.float64]
SCHEMA = "hjcamp.diagnosis/2"
WORST = 8
# Windows that are told as the places of an error.
PLACES = 3


def floor_size(analysis: Analysis) -> float:
    """Return the size of the floor, as `likelihood.size` gives it of features."""
    moments = analysis.floor.moments
    return float(np.exp(0.5 * np.linalg.slogdet(moments)[1] / len(moments)))


def answer(analysis: Analysis, verdict: Verdict, seconds: float) -> dict[str, Any]:
    """Return the answer as plain values."""
    model, base = verdict.model, analysis.base
    least, unknowns = floor_size(analysis), unknown_rows(analysis, verdict)
    return {
        "schema": SCHEMA,
        "plant": analysis.measured.plant.name,
        "verdict": verdict.word,
        "effects": list(verdict.effects),
        "drivers": drivers_of(unknowns) or (["time"] if verdict.swing else []),
        "p_value": float(verdict.p_value),
        "candidates": candidates(analysis, verdict),
        "error": {"baseline": base.left_out / least, "augmented": verdict.shown.left_out / least, "floor": 1.0},
        "channels": channel_rows(analysis, verdict.shown),
        **whole_rows(analysis, verdict.shown),
        "calibration": calibration(analysis),
        "calibration_with_effects": calibration(analysis, model) if verdict.effects else {},
        "calibration_with_unknown": calibration(analysis, verdict.unknown) if verdict.unknown else {},
        "where": [],
        "worst": worst(analysis, model),
        "minimum_detectable": {},
        "law_left": float(np.clip(verdict.law_left, 0.0, 1.0)),
        "unknowns": unknowns,
        "false_claims": {} if analysis.measured.repeated else _false_claims(analysis, verdict),
        "swings": swing_row(verdict.swing) if verdict.swing else {},
        "by_condition": by_condition_row(analysis, verdict.differs) if verdict.differs else {},
        "constants": {one.interval.name: constant_row(analysis, one) for one in verdict.constants},
        "follows_motion": {
            "share": verdict.follows, "quantities": _leading(analysis, verdict), "beside_law": _beside_law(analysis, verdict),
        },
        "confidence_set": [list(names) for names in verdict.confidence_set],
        "floor": floor_rows(analysis),
        "ends": end_rows(analysis.windows.layout),
        "still": still_rows(analysis.measured),
        "rests_on": {
            "conditions": len(analysis.measured.conditions),
            "tests": len(analysis.measured.tests),
            "chapters": len(np.unique(analysis.search.blocks)),
            "windows": len(analysis.windows.starts),
        },
        "twice": [list(pair) for pair in analysis.measured.twice],
        "short": [list(pair) for pair in analysis.measured.short],
        "missing": [list(pair) for pair in analysis.measured.missing],
        "lacking": list(verdict.lacking),
        "window_samples": analysis.windows.layout.width,
        "simulated_through": analysis.windows.layout.memory > 0,
        "seconds": round(seconds, 3),
    }  # fmt: skip


def swing_row(swing: Swing) -> dict[str, Any]:
    """Return what swings by itself, in the unit of its sensor's field."""
    sensor = swing.sensor
    return {
        "channel": sensor.field,
        "frequency_hz": swing.frequency,
        "rms": float(swing.rms * sensor.scale),
        "unit": sensor.unit,
        "left": swing.left,
        "chance": swing.chance,
    }


def by_condition_row(analysis: Analysis, differs: Differs) -> dict[str, Any]:
    """Return what a base for each condition leaves, over the floor, and the parameters that differ, by condition."""
    plant = analysis.measured.plant
    units = {name: "s" if name.startswith(DELAY) else plant.parameters[name].unit for name in differs.parameters}
    return {
        "left": differs.left_out / floor_size(analysis),
        "parameters": {
            name: {"unit": units[name], "conditions": {at: {"value": one.value, **one.row} for at, one in found.items()}}
            for name, found in differs.parameters.items()
        },
    }


def constant_row(analysis: Analysis, one: Constant) -> dict[str, Any]:
    """Return a constant of the plant's file: as it is given, as tests have it, and what that leaves, over the floor."""
    item = analysis.measured.plant.parameters[one.interval.name]
    left = one.left_out / floor_size(analysis)
    return {"unit": item.unit, "declared": item.default, "value": one.interval.value, **one.interval.row, "left": left}


def _false_claims(analysis: Analysis, verdict: Verdict) -> dict[str, float]:
    """Return the published rates of the look that found a free law where one was found, else of the first look."""
    steps = analysis.search.steps
    found = (one for one in steps if verdict.unknown and not verdict.effects and verdict.unknown in one.unknown)
    return next((one.false_claims for one in (*found, *steps)), {})


def _leading(analysis: Analysis, verdict: Verdict) -> list[str]:
    search, base = analysis.search, analysis.base
    if not verdict.follows:
        return []
    return leading(search.windows.layout, base.features, search.blocks, search.predicted(base))


def _beside_law(analysis: Analysis, verdict: Verdict) -> float:
    """Return which share of the rms that a free law leaves follows from the motion all the same; 0 where no such law is the answer."""
    return analysis.search.follows_motion(verdict.unknown).share if verdict.unknown and not verdict.effects else 0.0


def channel_rows(analysis: Analysis, model: Scored) -> dict[str, dict[str, Any]]:
    """Return each channel's rms over windows, before and after, and its floor, in the unit of its field."""
    layout = analysis.windows.layout
    before = in_units(np.mean(analysis.base.fitted.features**2, axis=0), layout)
    after = in_units(np.mean(model.fitted.features**2, axis=0), layout)
    floor = analysis.floor.of_sensors(layout)
    return {
        one.field: {
            "baseline": float(before[k] * one.scale),
            "augmented": float(after[k] * one.scale),
            "floor": float(floor[k] * one.scale),
            "unit": one.unit,
        }
        for k, one in enumerate(layout.measured.sensors)
    }


def whole_rows(analysis: Analysis, model: Scored) -> dict[str, Any]:
    """Return each channel's error over ``whole_tests``, before and after, in the unit of its field, and which of both ``runs_away``.

    There are no rows where either is not looked at; a model alone that is not, beside one that is, runs away or forgets no start.
    """
    found = {"baseline": _whole_of(analysis, analysis.base)}
    found["augmented"] = found["baseline"] if model is analysis.base else _whole_of(analysis, model)
    seen = {key: one for key, one in found.items() if one is not None}
    rows = {
        one.field: {"unit": one.unit, **{key: whole_row(whole, k, one) for key, whole in seen.items()}}
        for k, one in enumerate(analysis.measured.sensors)
    }
    return {"whole_tests": rows if len(seen) == 2 else {}, "runs_away": sorted(found.keys() - seen.keys()) if seen else []}


def _whole_of(analysis: Analysis, model: Scored) -> Whole | None:
    windows = replace(analysis.windows)
    windows.place = model.place
    return whole_error(windows, model.fitted.candidate)


def whole_row(whole: Whole, k: int, sensor: Sensor) -> dict[str, float]:
    """Return what a model errs by in sensor k over whole tests, in the unit of its field, and the share that it explains."""
    return {"whole_rms": float(whole.rms[k] * sensor.scale), "whole_r2": float(whole.explained[k])}


def floor_rows(analysis: Analysis) -> dict[str, dict[str, Any]]:
    """Return the floor of each channel with its bracket: the sensor's noise alone, and what the calibrated model leaves."""
    layout = analysis.windows.layout
    noise = in_units(np.ones(analysis.floor.moments.shape[0]), layout)
    found = {}
    for name, row in channel_rows(analysis, analysis.base).items():
        k = next(k for k, one in enumerate(layout.measured.sensors) if one.field == name)
        known = analysis.floor.source != "sensor"
        found[name] = {
            "source": analysis.floor.source if known else "unknown",
            "value": row["floor"] if known else None,
            "unit": row["unit"],
            "low": float(noise[k] * layout.measured.sensors[k].scale),
            "high": row["baseline"],
        }
    return found


def still_rows(measured: Measured) -> dict[str, dict[str, Any]]:
    """Return the recorded inputs that keep one value in all tests, in the unit of their field."""
    units = {field: unit_of_field(field, measured.plant.name) for field in measured.still}
    return {field: {"value": value * units[field].scale, "unit": units[field].shown} for field, value in measured.still.items()}


def end_rows(layout: Layout) -> dict[str, dict[str, Any]]:
    """Return the ends of each sensor that the tests reach, in the unit of its field, and the share of its readings that are there."""
    found = {}
    for one, (low, high), there in zip(layout.measured.sensors, layout.measured.ends, layout.at_ends.T, strict=True):
        ends = {key: float(end * one.scale) if np.isfinite(end) else None for key, end in (("low", low), ("high", high))}
        if any(end is not None for end in ends.values()):
            found[one.field] = {**ends, "unit": one.unit, "share": float(np.mean(there))}
    return found


def worst(analysis: Analysis, model: Scored) -> list[dict[str, Any]]:
    """Return the conditions with the largest error over the floor, the worst first, each with what its repetitions share of it.

    ``at`` are the fewest windows that hold half of its mean square, where these are few: the test of each, and when it begins.
    """
    layout = analysis.windows.layout
    floor = np.maximum(analysis.floor.of_sensors(layout), 1e-300)
    rows: list[dict[str, Any]] = []
    for condition, tests in layout.measured.conditions.items():
        inside = np.isin(layout.of_test, tests)
        if not inside.any():
            continue
        left = in_units(np.mean(model.fitted.features[inside] ** 2, axis=0), layout) / floor
        both = shared(layout, model.fitted.features, tests)
        rows += [
            {
                "condition": condition,
                "channel": one.field,
                "over_floor": float(left[k]),
                "shared": None if both is None else float(both[k] * one.scale),
                "unit": one.unit,
                "at": _few_windows(layout, model.fitted.features, np.flatnonzero(inside), k),
            }
            for k, one in enumerate(layout.measured.sensors)
        ]
    return sorted(rows, key=lambda row: -row["over_floor"])[:WORST]


def _few_windows(layout: Layout, features: Array, rows: NDArray[np.int64], k: int) -> list[dict[str, Any]]:
    """Return the test and the begin, s, of the fewest windows that hold half of what a sensor errs by; none where these are many."""
    squares = (features[rows] ** 2).reshape(len(rows), len(layout.measured.sensors), -1)[:, k].sum(axis=1)
    largest = np.argsort(squares)[::-1]
    count = int(np.searchsorted(np.cumsum(squares[largest]), 0.5 * squares.sum())) + 1
    return [
        {"test": layout.measured.tests[layout.of_test[row]].name, "time_s": float(layout.time[row * layout.width])}
        for row in np.sort(rows[largest[:count]])
        if count <= PLACES
    ]


def calibration(analysis: Analysis, model: Scored | None = None) -> dict[str, dict[str, Any]]:
    """Return every base parameter: as declared, and as these tests have it; and how far contacts give way, where that is seen.

    So the base has it by itself, or with what a ``model`` has found: an additive law's curve is drawn for that, one of a parameter
    about its mean over the knots. What the model had before, its effects, is fitted again with it.
    """
    plant, found, had = analysis.measured.plant, {}, analysis.start.effects
    forms = {name: analysis.search.library[name] for name in analysis.base.names if name not in had}
    laws = [analysis.search.unknowns[name] for name in (model or analysis.base).names if name in analysis.search.unknowns]
    values = {one.place: one for one in laws if one.quantity == "value"}
    for one in intervals((model or analysis.base).fitted, analysis.search.blocks):
        if model and not one.effect and one.name in values:
            one = mean_over_knots(analysis, model, values[one.name], one)
        if one.effect in forms and one.name == forms[one.effect].granted:
            item = forms[one.effect].parameters[one.name]
            found[f"{one.effect} {one.name}"] = {
                "published": 0.0,
                "value": one.value,
                "unit": item.unit,
                **one.row,
            }
        if one.effect in had:
            unit = analysis.search.library[one.effect].parameters[one.name].unit
            found[f"{one.effect} {one.name}"] = {
                "published": had[one.effect][one.name],
                "value": one.value,
                "unit": unit,
                **one.row,
                "at_bound": one.at_bound,
            }
        if one.effect or one.name.startswith(ZERO):
            continue
        declared = 0.0 if one.name.startswith(DELAY) else plant.parameters[one.name].default
        unit = "s" if one.name.startswith(DELAY) else plant.parameters[one.name].unit
        found[one.name] = {
            "published": declared,
            "value": one.value,
            "unit": unit,
            **one.row,
            "at_bound": one.at_bound,
            **({"held": True} if model is None and one.name in analysis.held else {}),
        }
    return found


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
    """Return a model without free laws, as a look fitted it, or fitted from what it has beside them."""
    search, names = analysis.search, set(model.names) - set(laws)
    known = (one for step in search.steps for one in step.named if set(one.names) == names)
    return next(known, None) or search.fitted(model.fitted.candidate.without(laws), model.fitted)


def asked_candidates(analysis: Analysis, verdict: Verdict, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return rows for effects that were asked for and were not fitted yet: each beside the calibrated model alone."""
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


def removed(analysis: Analysis, model: Scored) -> float:
    """Return the share of the removable error (above the floor) that a model removes on held-out blocks."""
    least = floor_size(analysis)
    above = np.log(max(analysis.base.left_out / least, 1.0 + 1e-12))
    return float(np.clip(np.log(analysis.base.left_out / model.left_out) / above, -1.0, 1.0))
