"""The answer of a diagnosis for programs: the keys of ``hjcamp.diagnosis/2``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import held_out
from hjcamp.diagnosis.decision.by_condition import Differs
from hjcamp.diagnosis.decision.given_constants import Constant, constants_otherwise
from hjcamp.diagnosis.decision.leading_regressors import leading
from hjcamp.diagnosis.decision.periodic_disturbance import Swing
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.results.calibration_rows import calibration
from hjcamp.diagnosis.results.candidate_rows import candidates, drivers_of, unknown_rows
from hjcamp.diagnosis.results.channel_rows import (
    channel_rows,
    end_rows,
    noise_floor_rows,
    noise_floor_size,
    still_rows,
    whole_rows,
    worst,
)
from hjcamp.diagnosis.results.formula_rows import formula_rows
from hjcamp.diagnosis.results.where_rows import where_rows
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.base_values import DELAY

Array = NDArray[np.float64]
SCHEMA = "hjcamp.diagnosis/2"


def answer(analysis: Analysis, verdict: Verdict, seconds: float) -> dict[str, Any]:
    """Return the answer as plain values; what it remarks changes no word of the verdict."""
    model, base = verdict.model, analysis.base
    least, unknowns = noise_floor_size(analysis), unknown_rows(analysis, verdict)
    return {
        "schema": SCHEMA,
        "plant": analysis.measured.plant.name,
        "verdict": verdict.word,
        "effects": list(verdict.effects),
        "drivers": drivers_of(unknowns) or (["time"] if verdict.swing else []),
        "outside": verdict.outside,
        "decision": decision_row(verdict),
        "p_value": float(verdict.gate.p_value),
        "candidates": candidates(analysis, verdict),
        "error": {"baseline": held_out(analysis, base) / least, "augmented": held_out(analysis, verdict.shown) / least, "floor": 1.0},
        "channels": channel_rows(analysis, verdict.shown),
        **whole_rows(analysis, verdict.shown),
        "calibration": calibration(analysis),
        "calibration_with_effects": calibration(analysis, model) if verdict.effects else {},
        "calibration_with_unknown": calibration(analysis, verdict.term) if verdict.term else {},
        "where": where_rows(analysis),
        "worst": worst(analysis, model),
        "minimum_detectable": {},
        "law_left": float(np.clip(verdict.law_left, 0.0, 1.0)),
        "unknowns": unknowns,
        "formulas": formula_rows(analysis, verdict),
        "swings": swing_row(verdict.swing) if verdict.swing else {},
        "by_condition": by_condition_row(analysis, verdict.differs) if verdict.differs else {},
        "constants": {one.interval.name: constant_row(analysis, one) for one in _constants(analysis, verdict)},
        "follows_motion": {"share": verdict.follows, "quantities": _leading(analysis, verdict)},
        "confidence_set": [list(names) for names in verdict.confidence_set],
        "false_claims": {},
        "floor": noise_floor_rows(analysis),
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
    """Return what oscillates by itself, in the unit of its sensor's field."""
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
    """Return what a base for each condition leaves, over the noise floor, and the parameters that differ, by condition."""
    plant = analysis.measured.plant
    units = {name: "s" if name.startswith(DELAY) else plant.parameters[name].unit for name in differs.parameters}
    return {
        "left": differs.left_out / noise_floor_size(analysis),
        "parameters": {
            name: {"unit": units[name], "conditions": {at: {"value": one.value, **one.row} for at, one in found.items()}}
            for name, found in differs.parameters.items()
        },
    }


def constant_row(analysis: Analysis, one: Constant) -> dict[str, Any]:
    """Return a constant of the plant's file: as it is given, as tests have it, and what that leaves, over the noise floor."""
    item = analysis.measured.plant.parameters[one.interval.name]
    left = one.left_out / noise_floor_size(analysis)
    return {"unit": item.unit, "declared": item.default, "value": one.interval.value, **one.interval.row, "left": left}


def decision_row(verdict: Verdict) -> dict[str, Any]:
    """Return what decided: the two numbers, p of the gate, the share that could be explained, and the blocks that it rests on."""
    gate = verdict.gate
    return {
        "alpha": verdict.alpha,
        "delta": verdict.delta,
        "p_value": gate.p_value,
        "gain": gate.gain,
        "upper": gate.upper if math.isfinite(gate.upper) else None,
        "blocks": gate.blocks,
        "models": len(verdict.named) + len(verdict.terms),
    }


def _constants(analysis: Analysis, verdict: Verdict) -> tuple[Constant, ...]:
    """Return the constants of the plant's file of which another value leaves no more than what was found."""
    if not (verdict.effects or verdict.term):
        return ()
    models = [*verdict.named, *verdict.terms, verdict.model]
    return constants_otherwise(analysis, min(one.left_out for one in models), verdict.shown)


def _leading(analysis: Analysis, verdict: Verdict) -> list[str]:
    search, base = analysis.search, analysis.base
    if not verdict.follows:
        return []
    layout = search.windows.layout
    return leading(layout, layout.predictions(base.features), search.blocks, search.predicted(base))


def removed(analysis: Analysis, model: Scored) -> float:
    """Return the share of the removable error (above the noise floor) that a model removes on held-out blocks."""
    least = noise_floor_size(analysis)
    before, after = held_out(analysis, analysis.base), held_out(analysis, model)
    return float(np.clip(np.log(before / after) / np.log(max(before / least, 1.0 + 1e-12)), -1.0, 1.0))
