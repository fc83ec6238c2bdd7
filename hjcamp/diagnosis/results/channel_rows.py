"""Rows of an answer that stand for channels: their errors, noise floors, ends, and the worst conditions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.repeatability import in_units, shared
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured, Sensor
from hjcamp.diagnosis.decision.whole_tests import whole_of
from hjcamp.diagnosis.residuals.free_run import Whole
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.language.field_unit import unit_of_field

Array = NDArray[np.float64]


WORST = 8


# Windows that are told as the places of an error.
PLACES = 3


def noise_floor_size(analysis: Analysis) -> float:
    """Return the size of the noise floor, as `likelihood.size` gives it of features."""
    moments = analysis.noise_floor.moments
    return float(np.exp(0.5 * np.linalg.slogdet(moments)[1] / len(moments)))


def channel_rows(analysis: Analysis, model: Scored) -> dict[str, dict[str, Any]]:
    """Return each channel's rms over windows, before and after, and its noise floor, in the unit of its field."""
    layout = analysis.windows.layout
    before = in_units(np.mean(analysis.base.fitted.features**2, axis=0), layout)
    after = in_units(np.mean(model.fitted.features**2, axis=0), layout)
    noise_floor = analysis.noise_floor.of_sensors(layout)
    return {
        one.field: {
            "baseline": float(before[k] * one.scale),
            "augmented": float(after[k] * one.scale),
            "floor": float(noise_floor[k] * one.scale),
            "unit": one.unit,
        }
        for k, one in enumerate(layout.measured.sensors)
    }


def whole_rows(analysis: Analysis, model: Scored) -> dict[str, Any]:
    """Return each channel's error over ``whole_tests``, before and after, in the unit of its field, and which of both ``runs_away``.

    There are no rows where either is not looked at; a model that is not, next to one that is, diverges or forgets no start.
    """
    found = {"baseline": whole_of(analysis, analysis.base)}
    found["augmented"] = found["baseline"] if model is analysis.base else whole_of(analysis, model)
    seen = {key: one for key, one in found.items() if one is not None}
    rows = {
        one.field: {"unit": one.unit, **{key: whole_row(whole, k, one) for key, whole in seen.items()}}
        for k, one in enumerate(analysis.measured.sensors)
    }
    return {"whole_tests": rows if len(seen) == 2 else {}, "runs_away": sorted(found.keys() - seen.keys()) if seen else []}


def whole_row(whole: Whole, k: int, sensor: Sensor) -> dict[str, float]:
    """Return what a model errs by in sensor k over whole tests, in the unit of its field, and the share that it explains."""
    return {"whole_rms": float(whole.rms[k] * sensor.scale), "whole_r2": float(whole.explained[k])}


def noise_floor_rows(analysis: Analysis) -> dict[str, dict[str, Any]]:
    """Return the noise floor of each channel with its bracket: the sensor's noise alone, and what the calibrated model leaves."""
    layout = analysis.windows.layout
    noise = in_units(np.ones(analysis.noise_floor.moments.shape[0]), layout)
    found = {}
    for name, row in channel_rows(analysis, analysis.base).items():
        k = next(k for k, one in enumerate(layout.measured.sensors) if one.field == name)
        known = analysis.noise_floor.source != "sensor"
        found[name] = {
            "source": analysis.noise_floor.source if known else "unknown",
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
    """Return the conditions with the largest error over the noise floor, the worst first, each with what its repetitions share of it.

    ``at`` are the fewest windows that hold half of its mean square, where these are few: the test of each, and when it begins.
    """
    layout = analysis.windows.layout
    noise_floor = np.maximum(analysis.noise_floor.of_sensors(layout), 1e-300)
    rows: list[dict[str, Any]] = []
    for condition, tests in layout.measured.conditions.items():
        inside = np.isin(layout.of_test, tests)
        if not inside.any():
            continue
        left = in_units(np.mean(model.fitted.features[inside] ** 2, axis=0), layout) / noise_floor
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
    squares = (layout.predictions(features[rows]) ** 2).reshape(len(rows), len(layout.measured.sensors), -1)[:, k].sum(axis=1)
    largest = np.argsort(squares)[::-1]
    count = int(np.searchsorted(np.cumsum(squares[largest]), 0.5 * squares.sum())) + 1
    return [
        {"test": layout.measured.tests[layout.of_test[row]].name, "time_s": float(layout.time[row * layout.width])}
        for row in np.sort(rows[largest[:count]])
        if count <= PLACES
    ]
