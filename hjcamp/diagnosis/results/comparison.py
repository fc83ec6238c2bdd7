"""Models side by side on measured tests of a plant: errors over windows, as they are and with their base calibrated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.calibration.contact_compliance import forms_among
from hjcamp.diagnosis.data.repeatability import in_units, not_above
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.estimation.gauss_newton import settled
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.residuals.free_run import Whole, whole_error
from hjcamp.diagnosis.results.channel_rows import end_rows, noise_floor_size, whole_row
from hjcamp.diagnosis.results.where_rows import where_rows
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shown:
    """One model on the tests: its rms over windows of each channel (sensors,), that of each test (tests, sensors), SI,
    what it explains of a window's motion (sensors,), its size over the noise floor, residuals (n, sensors), and error over whole
    tests, where windows are shorter.
    """

    name: str
    rms: Array
    by_test: Array
    explained: Array
    score: float
    errors: Array
    whole: Whole | None = None


@dataclass(frozen=True)
class Comparison:
    """Models on the same tests, and the last of them with its parameters calibrated on these tests."""

    analysis: Analysis
    models: tuple[Shown, ...]
    calibrated: Shown


def compared(
    measured: Measured,
    library: Mapping[str, type[Effect]],
    models: Mapping[str, Candidate],
    report: Callable[[str, float], None] = lambda text, share: None,
) -> Comparison:
    """Return every model on the tests, the window's starts moved to where each fits best.

    What is calibrated has the form of its contacts, as the base of a diagnosis has: both give the same error and noise floor.
    """
    needed = {name for model in models.values() for name in model.effects}
    chosen = {name: effect for name, effect in library.items() if name in needed}
    last = list(models.values())[-1]
    analysis = calibrated(measured, chosen, last, report, unknowns=False, forms=forms_among(library))
    seen = {}
    for done, (name, model) in enumerate(models.items()):
        report(f"predicting with {name}", 0.5 + 0.4 * done / len(models))
        seen[name] = predicted_errors(analysis, whole_model(measured, model))
    fitted = analysis.base.fitted.features, errors_of_base(analysis)
    noise_floor = analysis.noise_floor
    for features, _ in (*seen.values(), fitted):
        noise_floor = not_above(noise_floor, features)
    analysis = replace(analysis, noise_floor=noise_floor)
    which = f"{list(models)[-1]}, calibrated here" if len(models) > 1 else "calibrated here"
    candidates = {name: whole_model(measured, model) for name, model in models.items()}
    *rows, last_row = (
        replace(shown_of(analysis, name, *found), whole=whole_error(analysis.windows, candidate))
        for (name, candidate), found in zip(
            [*candidates.items(), (which, analysis.base.fitted.candidate)], [*seen.values(), fitted], strict=True
        )
    )
    return Comparison(analysis, tuple(rows), last_row)


def predicted_errors(analysis: Analysis, candidate: Candidate) -> tuple[Array, Array]:
    """Return features (windows, d) and errors (n, sensors) of a model, the starts moved to where it fits best.

    They begin as measured, whatever other models were looked at before.
    """
    windows, first = replace(analysis.windows), analysis.search.first
    assert first is not None
    windows.starts, windows.remembered = first.starts.copy(), {}
    windows.move_starts(candidate, rounds=1)
    return settled(windows, candidate, ()).features, windows.errors(candidate)


def errors_of_base(analysis: Analysis) -> Array:
    """Return the errors (n, sensors) of the calibrated model from the starts of its fit, as in a diagnosis."""
    windows = replace(analysis.windows)
    windows.place = analysis.base.place
    return windows.errors(analysis.base.fitted.candidate)


def whole_model(measured: Measured, model: Candidate) -> Candidate:
    """Return a model with every base parameter given, as declared where it has none."""
    declared = {one: measured.plant.parameters[one].default for one in measured.plant.base_parameters}
    return Candidate({**declared, **model.base}, model.effects)


def shown_of(analysis: Analysis, name: str, features: Array, errors: Array) -> Shown:
    layout = analysis.windows.layout
    rms = in_units(np.mean(features**2, axis=0), layout)
    tests = range(len(layout.measured.tests))
    by_test = np.array(
        [
            in_units(np.mean(features[layout.of_test == test] ** 2, axis=0), layout)
            if np.any(layout.of_test == test)
            else np.full(len(rms), np.nan)
            for test in tests
        ]
    )
    spread = np.mean((layout.readings - layout.means) ** 2, axis=0)
    left = np.mean(errors**2, axis=0)
    explained = 1.0 - left / np.maximum(spread, 1e-300)
    return Shown(name, rms, by_test, explained, size(layout.predictions(features)) / noise_floor_size(analysis), errors)


def _number(value: float) -> float | None:
    """Return a number as JSON has it: nothing where a model diverges."""
    return float(value) if np.isfinite(value) else None


def answer(found: Comparison) -> dict[str, Any]:
    """Return the comparison for programs, by the keys of ``hjcamp.comparison/1``."""
    layout = found.analysis.windows.layout
    noise_floor = found.analysis.noise_floor.of_sensors(layout)
    models = []
    for one in (*found.models, found.calibrated):
        error = {
            sensor.field: {
                "rms": _number(one.rms[k] * sensor.scale),
                "floor": float(noise_floor[k] * sensor.scale),
                "r2": _number(one.explained[k]),
                **(whole_row(one.whole, k, sensor) if one.whole else {}),
            }
            for k, sensor in enumerate(layout.measured.sensors)
        }
        models.append({"name": one.name, "tests": len(layout.measured.tests), "error": error, "score": _number(one.score)})
    return {
        "schema": "hjcamp.comparison/1", "plant": layout.measured.plant.name, "models": models[:-1], "calibrated": models[-1],
        "window_s": layout.width * layout.measured.period, "floor_source": found.analysis.noise_floor.source,
        "where": where_rows(found.analysis),
        "ends": end_rows(layout),
    }  # fmt: skip
