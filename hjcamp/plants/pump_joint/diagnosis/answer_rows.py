"""What version 2 of a diagnosis' answer says beyond version 1: how much of the law is left, the floor, the worst tests."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hjcamp.diagnosis.decision.effect_size import in_proportion
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import JUDGED
from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS
from hjcamp.plants.pump_joint.diagnosis.scale import HEADLINE, Judged, Scale

WORST = 8
# What each residual is, SI.
RESIDUALS = {
    "arm": ("arm angle", "rad"),
    "difference": ("pressure difference", "Pa"),
    "line_sum": ("pressure sum", "Pa"),
    "line_difference": ("pressure difference", "Pa"),
    "sliding": ("force on the sliders", "N"),
    "breakaway": ("breakaway force", "N"),
    "home": ("first reading", "rad"),
}
# What tests may differ by, as their metadata name it.
VALUES = ("trajectory", "controller", "preload_mpa", "adjustment_mpa", "payload", "orientation", "pump", "tubing", "amplifier")


def law_left(found: Diagnosis, fit: Fit) -> float:
    r"""Return the share of the error above what twins may leave that a fit leaves of the calibrated model's, 0 to 1.

    .. math:: \sum_c \max(r_c^2 - h_c^2, 0)_{fit} \Big/ \sum_c \max(r_c^2 - h_c^2, 0)_{base}

    with r the error over that of the twins in each channel (`Null.over`) and h what 95 % of them stay below: of a weak effect
    nothing can be told that chance leaves as well. 0 where the base leaves nothing or there are no twins.
    """
    if not len(found.null.logarithms):
        return 0.0
    highest = found.null.highest()[:JUDGED]
    before, after = (
        float(np.sum(np.maximum(found.null.over(one.mean_square)[:JUDGED] ** 2 - highest**2, 0.0)))
        for one in (found.baseline, fit)
    )
    return float(np.clip(after / before, 0.0, 1.0)) if before > 0.0 else 0.0


def law_left_of(found: Diagnosis) -> float:
    """Return the share that the verdict leaves: 1 where nothing of the library is it, 0 where nothing is missing."""
    if found.verdict in ("effect", "one_of"):
        return law_left(found, found.final)
    return 1.0 if found.verdict == "outside_library" else 0.0


def functional(found: Diagnosis, name: str, fit: Fit, parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the rms by which an effect changes the residual that it changes most over its floor, SI.

    Whatever its law, it compares with that of another one; the 95 % interval is in proportion to that of its amplitude.
    """
    effect = next(one for one in found.fitter.views.effects if one.name == name)
    change = found.fitter.look(fit.candidate.without([name])).features - fit.features
    squares = found.features.mean_square(np.nan_to_num(change))
    seen = np.array([np.mean(column[column > 0.0]) if np.any(column > 0.0) else 0.0 for column in squares.T])
    rms = np.sqrt(seen)
    most = int(np.argmax(np.divide(rms, found.noise_floor, out=np.zeros_like(rms), where=found.noise_floor > 0.0)))
    said, unit = RESIDUALS[CHANNELS[most]]
    value = float(rms[most])
    return {"name": f"change of {said}", "value": value, "unit": unit, "ci95": in_proportion(effect, parameters, value)}


def confidence_set(found: Diagnosis) -> list[list[str]]:
    """Return every set of effects that the tests do not rule out: the empty one where nothing is missing, none outside the library."""
    if found.verdict == "nothing_missing":
        return [[]]
    if found.verdict not in ("effect", "one_of"):
        return []
    certain = [name for name in found.effects if name not in found.undecided]
    beside = [step.best for step in found.taken if step.best not in (*found.undecided, *certain)]
    return [[*certain, *beside, name] for name in found.undecided] or [certain]


def noise_floor_rows(scale: Scale, before: Judged) -> dict[str, dict[str, Any]]:
    """Return the floor of arm and lines in the log's units, between the sensor's own and what the calibrated model leaves."""
    rows = {}
    for name in HEADLINE:
        value, error = scale.noise_floors.get(name), before.errors.get(name)
        high = error.rms if error is not None else scale.spreads[name]
        rows[name] = {
            "source": "repetitions" if value is not None else "unknown",
            "value": value,
            "unit": unit_of_field(name, "plant pump_joint").shown,
            "low": min(value, high) if value is not None else 0.0,
            "high": max(value or 0.0, high),
        }
    return rows


def worst(evidence: Evidence, scale: Scale, after: Judged) -> list[dict[str, Any]]:
    """Return the conditions and channels with the largest error over the floor on tests that were held out, the worst first.

    Each with what its repetitions share of that error, in the log's unit.
    """
    rows: list[dict[str, Any]] = []
    for condition in dict.fromkeys(evidence.tests[place].condition for place in after.places):
        here = [k for k, place in enumerate(after.places) if evidence.tests[place].condition == condition]
        for name in HEADLINE:
            noise_floor = scale.noise_floors.get(name) or max(scale.spreads[name], 1e-12)
            left = float(np.sqrt(np.mean(np.square([after.of_tests[name][k] for k in here]))))
            shared = after.shared[name][condition]
            rows.append({
                "condition": condition, "channel": name, "over_floor": left / noise_floor,
                "shared": shared if np.isfinite(shared) else None, "unit": unit_of_field(name, "plant pump_joint").shown,
            })  # fmt: skip
    return sorted(rows, key=lambda row: -row["over_floor"])[:WORST]


def rests_on(evidence: Evidence) -> dict[str, int]:
    """Return how many tests and conditions the answer rests on, and how many values of what differs between them."""
    seen: Mapping[str, set[str]] = {
        name: {test.log.metadata.get(name, "") for test in evidence.tests} - {""} for name in VALUES
    }
    differ = {name: len(values) for name, values in seen.items() if values}
    return {"tests": len(evidence.tests), "conditions": len(evidence.conditions), **differ}
