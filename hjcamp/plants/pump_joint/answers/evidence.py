"""The evidence of a diagnosis of the pump joint: what is missing, the law, the worst test, chance, correlations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
    from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
    from hjcamp.plants.pump_joint.diagnosis.localisation.unexplained import Unexplained
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
    from hjcamp.report.pictures.evidence import Branch, Missing

POINTS = 1500
PERIOD = 4e-3
# What the evidence calls the first three readings, their names and SI units.
CHANNELS = {"arm": ("arm angle", "rad"), "pressure1": ("pressure 1", "Pa"), "pressure2": ("pressure 2", "Pa")}


@dataclass(frozen=True)
class Shown:
    """What the pictures need that takes simulations: what is missing, and predictions by model, SI.

    ``readings`` (n, 3) are of whole tests, each from its first sample, ``windows`` (n, 3) begin at measured states.
    """

    missing: Missing
    readings: Mapping[str, Any]
    windows: Mapping[str, Any]


def gathered(found: Diagnosis, content: dict[str, Any], library: Mapping[str, type[Effect]]) -> Shown:
    """Return what the pictures of the evidence need; simulates the tests with each model once more."""
    added = [name for name in found.final.candidate.effects if name not in found.baseline.candidate.effects]
    models = {"calibrated": found.baseline}
    if added:
        models[f"with {' and '.join(added)}"] = found.final
    views = found.fitter.views
    readings = {name: views.joint_readings(fit.candidate, windows=False)[:, :3] for name, fit in models.items()}
    windows = {name: views.joint_readings(fit.candidate)[:, :3] for name, fit in models.items()}
    return Shown(missing_of(found, content, library, added), readings, windows)


def missing_of(found: Diagnosis, content: dict[str, Any], library: Mapping[str, type[Effect]], added: list[str]) -> Missing:
    """Return what the calibrated model misses over its likeliest driver, what the named law says there, and what is left.

    Where effects were named, the driver is that of their law. A law of the lines may depend on the very pressures.
    """
    from hjcamp.commands.any_plant.evidence import amplitude_band
    from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import TAUTOLOGIES, rank_drivers
    from hjcamp.plants.pump_joint.diagnosis.localisation.unexplained import IN_SI, SI, driver_of, unexplained
    from hjcamp.report.pictures.evidence import Missing

    features, noise_floor = found.features, found.noise_floor
    lost = found.baseline
    if added:
        without = found.fitter.look(found.final.candidate.without(added))
        lost = replace(found.final, features=without.features - found.final.features)
    barred = {"sliding": TAUTOLOGIES["sliding"]} if added else TAUTOLOGIES
    driver, channel, _ = rank_drivers(features, lost, noise_floor, barred)[0]
    if added:
        # the lines' residuals are pressures, of which a flow is the rate
        driver = driver_of(features, lost, channel, barred.get(channel, ()))

    def over(fit: Fit) -> Unexplained:
        return unexplained(features, fit, driver, channel)

    before = over(found.baseline)
    law: tuple[Branch, ...] = ()
    after: tuple[Branch, ...] = ()
    if added:
        law = _branches(over(lost), SI)
        low, high = amplitude_band(content["candidates"], added, library)
        law = tuple(replace(one, **_ends(one, low, high)) for one in law)
        after = _branches(over(found.final), SI)
    return Missing(
        driver.replace("_", " "), IN_SI.get(before.driver_unit, before.driver_unit) or "1", f"missing {before.quantity}",
        IN_SI.get(before.unit, before.unit), _branches(before, SI), law, after, " and ".join(added),
    )  # fmt: skip


def _branches(curve: Unexplained, factors: Mapping[str, float]) -> tuple[Branch, ...]:
    from hjcamp.report.pictures.evidence import BACKWARD, FORWARD, Branch

    wide, tall = factors[curve.driver_unit], factors[curve.unit]
    return tuple(
        Branch(way, wide * curve.centres, tall * values)
        for way, values in ((FORWARD, curve.forward), (BACKWARD, curve.backward))
        if np.isfinite(values).any()
    )


def _ends(one: Branch, low: float, high: float) -> dict[str, Any]:
    ends = np.sort(np.stack([low * one.y, high * one.y]), axis=0)
    return {"low": ends[0], "high": ends[1]}


def evidence_pictures(found: Diagnosis, shown: Shown) -> dict[str, str]:
    """Return the pictures of the evidence by name, in order."""
    from hjcamp.records.log import observed
    from hjcamp.report.pictures.evidence import draw_correlations, draw_gains, draw_missing, draw_worst_test

    pictures = {f"missing_{name}": svg for name, svg in draw_missing(shown.missing).items()} if shown.missing.before else {}
    pictures["worst_test"] = draw_worst_test(
        *_worst_test(found, shown), observed=observed(test.log for test in found.features.evidence.tests)
    )
    step = found.steps[0] if found.steps else None
    chance = step.null_gains if step else found.null.gains
    if len(chance):
        pictures["gains"] = draw_gains(chance, step.gain if step else None, "simulations with nothing missing")
    return pictures | draw_correlations(*_correlations(found, shown))


def _worst_test(found: Diagnosis, shown: Shown) -> tuple[Any, ...]:
    """Return the arguments of the picture of the test that the calibrated model predicts worst, each run from its first sample.

    In the channel whose error falls most with what was named, the arm where nothing was.
    """
    from hjcamp.report.wording.names import readable

    evidence = found.features.evidence
    k, errors = blamed_channel(found, shown)
    measured = _measured(evidence)
    worst = max(range(len(evidence.tests)), key=lambda one: float(np.nanmean(errors[0][_rows(evidence, one), k])))
    rows = _rows(evidence, worst)
    rows = rows[:: max(1, len(rows) // POINTS)]
    models = [(name, one[rows, k]) for name, one in shown.readings.items()]
    name, unit = list(CHANNELS.values())[k]
    title = f"worst test: {readable(evidence.tests[worst].name.removesuffix('.mcap'))}"
    return title, name, unit, evidence.joined("time")[rows], measured[rows, k], models


def blamed_channel(found: Diagnosis, shown: Shown) -> tuple[int, list[NDArray[np.float64]]]:
    """Return the channel whose error falls most with what was named, the arm where nothing was, and each model's squares (n, 3)."""
    measured = _measured(found.features.evidence)
    errors = [(readings - measured) ** 2 for readings in shown.readings.values()]
    whole = [np.nanmean(one, axis=0) for one in errors]
    return int(np.argmin(whole[-1] / np.maximum(whole[0], 1e-300))), errors


def _measured(evidence: Evidence) -> NDArray[np.float64]:
    return np.column_stack([evidence.joined(name) for name in CHANNELS])


def _rows(evidence: Evidence, test: int) -> NDArray[np.int64]:
    return np.arange(evidence.edges[test], evidence.edges[test + 1])


def _correlations(found: Diagnosis, shown: Shown) -> tuple[list[tuple[str, Any]], list[Any]]:
    """Return the correlations of each model's error over windows, with the pump's motion, and those between repetitions.

    Of the channel that is to blame (`blamed_channel`); between repetitions of what the last model leaves.
    """
    from hjcamp.report.tables.correlations import correlations, of_repetitions

    evidence = found.features.evidence
    parts = [slice(int(a), int(b)) for a, b in zip(evidence.edges[:-1], evidence.edges[1:], strict=True)]
    k, _ = blamed_channel(found, shown)
    measured, pump = _measured(evidence)[:, k], {"the pump's angle": evidence.joined("pump")}
    errors = {name: np.nan_to_num(one[:, k] - measured) for name, one in shown.windows.items()}
    repeated = [[parts[test] for test in tests] for tests in evidence.conditions.values()]
    models = [(name, correlations(error, pump, parts, PERIOD)) for name, error in errors.items()]
    return models, of_repetitions(list(errors.values())[-1], pump, repeated, PERIOD)
