"""Say what is missing: calibrate, screen, fit, judge against simulated twins, and give one of exactly five verdicts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.baseline import calibrate
from hjcamp.discrepancy.drivers import rank_drivers, top_drivers
from hjcamp.discrepancy.evidence import Evidence
from hjcamp.discrepancy.features import Features
from hjcamp.discrepancy.fit import Fit, Fitter
from hjcamp.discrepancy.gram import all_gains, project
from hjcamp.discrepancy.repetition import RepetitionScatter, scatter_of
from hjcamp.discrepancy.search import Screening, fit_effect, rival_weights, screen, strongest
from hjcamp.discrepancy.twins import make_twin, match_scatter
from hjcamp.discrepancy.views import CHANNELS, Views
from hjcamp.model.effect import Effect

Array = NDArray[np.float64]
LEVEL = 0.05
POSTERIOR = 0.8
MATTERS = 0.10
LEAST_GAIN = 6.0
MARGIN = 1.25


@dataclass(frozen=True)
class Effort:
    """How much work a diagnosis may do: twins, fitted survivors of the screening, Gauss-Newton steps, further effects."""

    twins: int
    survivors: int
    steps: int
    forward: int


EFFORTS = {"quick": Effort(24, 4, 4, 1), "standard": Effort(60, 6, 8, 2), "thorough": Effort(300, 10, 14, 3)}


@dataclass(frozen=True)
class Step:
    """One step forward: the screening, the fits of its survivors, and their weights."""

    screening: Screening
    fits: dict[str, Fit]
    weights: dict[str, float]
    p_value: float

    @property
    def best(self) -> str:
        """The effect that fits best."""
        return min(self.fits, key=lambda name: self.fits[name].loss)

    @property
    def gain(self) -> float:
        """By how much the loss falls with the best effect."""
        return self.screening.about.loss - self.fits[self.best].loss


@dataclass(frozen=True)
class Null:
    """What twins in which nothing is missing give: the largest gain of each, and their error over their floor."""

    gains: Array
    adequacy: Array

    def p_value(self, gain: float) -> float:
        """Return how often a twin gains as much."""
        return float((1 + np.sum(self.gains >= gain)) / (1 + len(self.gains)))

    def limit(self) -> Array:
        """Return the error over floor (channels,) that 95 % of the twins stay below, with a margin for model form."""
        return np.asarray(np.quantile(self.adequacy, 0.95, axis=0) * MARGIN)


@dataclass
class Diagnosis:
    """The answer and all that stands behind it."""

    verdict: str
    effects: list[str]
    drivers: list[str]
    p_value: float
    baseline: Fit
    final: Fit
    floor: Array
    null: Null
    steps: list[Step]
    features: Features
    fitter: Fitter
    scatter: RepetitionScatter
    reason: str
    seconds: float
    detectable: dict[str, tuple[str, float, str]] = field(default_factory=dict)
    exploratory: bool = False


def ratio(features: Features, fit: Fit, floor: Array) -> Array:
    """Return the error over the floor (channels,)."""
    valid = np.maximum(features.valid.sum(axis=0), 1)
    return np.asarray(np.sqrt((fit.features**2).sum(axis=0) / valid) / np.maximum(floor, 1e-30))


def simulate_null(
    views: Views, fit: Fit, screening: Screening, scatter: RepetitionScatter, count: int, seed: int, tick: Callable[[], None]
) -> Null:
    """Return what ``count`` twins of the fitted model give in the same screening."""
    gains, adequacy = [], []
    for number in range(count):
        twin = make_twin(views, fit.candidate, scatter, seed * 1000 + number)
        own = Features(twin)
        residual = own.of(Views(twin, views.effects).residuals(fit.candidate))
        _, found, coefficients = all_gains(screening.gram, residual, screening.known, screening.groups)
        gains.append(max(row[2] for row in strongest(screening.probes, found, coefficients).values()))
        floor = own.floor(residual)
        left = error_beside_base(screening, residual)
        adequacy.append(np.sqrt((left * own.counts).sum(axis=0) / own.counts.sum(axis=0)) / np.maximum(floor, 1e-30))
        tick()
    return Null(np.array(gains), np.array(adequacy))


def error_beside_base(screening: Screening, residual: Array) -> Array:
    """Return the mean square (tests, channels) that the base parameters cannot take up."""
    gram, count = screening.gram, len(screening.known)
    cross, square = gram.with_residual(residual)
    free, every = np.zeros(count, dtype=np.bool_), np.ones(len(square))
    return np.asarray(project(gram.products, cross, square, gram.least, np.arange(count), free, screening.known, every, 3)[2])


def matters(features: Features, before: Fit, after: Fit) -> bool:
    """Whether the error falls by a tenth in some channel of two conditions at least (or of the only one)."""
    conditions = list(features.evidence.conditions.values())
    better = 0
    for tests in conditions:
        fall = 1.0 - np.sqrt(after.mean_square[tests].sum(axis=0) / np.maximum(before.mean_square[tests].sum(axis=0), 1e-30))
        better += bool(np.max(fall) > MATTERS)
    return better >= min(2, len(conditions))


def detectable_amplitudes(screening: Screening, effects: Sequence[type[Effect]], needed: float) -> dict[str, tuple[str, float, str]]:
    """Return for each effect the amplitude whose predicted gain would have been ``needed``: (parameter, value, unit)."""
    found: dict[str, tuple[str, float, str]] = {}
    by_name = {effect.name: effect for effect in effects}
    base = len(screening.known)
    for probe in screening.probes:
        effect = by_name[probe.effect]
        for name, column in zip(probe.lifted, probe.columns, strict=True):
            if not name:
                continue
            response = screening.gram.columns[base + column]
            smallest = _amplitude_for(screening, base + column, response, needed) * abs(probe.parameters[name])
            key = probe.effect
            if math.isfinite(smallest) and (key not in found or smallest < found[key][1]):
                found[key] = (name, smallest, effect.parameters[name].unit)
    return found


def _amplitude_for(screening: Screening, column: int, response: Array, needed: float) -> float:
    gram, features = screening.gram, screening.gram.features
    square = features.mean_square(screening.about.features) + gram.least**2
    own = list(range(len(screening.known)))
    products = gram.products / square[:, :, None, None]
    total = products.sum(axis=(0, 1))
    a = total[np.ix_(own, own)] + np.diag(screening.known) + 1e-9 * np.eye(len(own))
    b = total[own, column]
    unexplained = total[column, column] - b @ np.linalg.solve(a, b)
    return math.sqrt(needed / unexplained) if unexplained > 1e-12 else math.inf


def diagnose(
    evidence: Evidence,
    effects: Sequence[type[Effect]],
    *,
    effort: str = "standard",
    seed: int = 1,
    report: Callable[[str, float], None] = lambda text, share: None,
) -> Diagnosis:
    """Return the diagnosis of the tests in ``evidence`` with the effects of the library.

    ``report(text, share)`` is called with what is being done and the share of the work that is done.
    """
    began = time.perf_counter()
    work = EFFORTS[effort]
    views = Views(evidence, tuple(effects))
    features = Features(evidence)
    report("calibrating the base parameters", 0.02)
    base, fitter = calibrate(views, features)
    floor = features.floor(base.features)
    report(f"screening {len(effects)} effects", 0.10)
    first = screen(fitter, base, effects)
    scatter = match_scatter(views, base, scatter_of(evidence, dict(base.candidate.base)))
    done = [0]

    def tick() -> None:
        done[0] += 1
        report(f"twin {done[0]} of {work.twins} with nothing missing", 0.20 + 0.35 * done[0] / work.twins)

    null = simulate_null(views, base, first, scatter, work.twins, seed, tick)
    steps: list[Step] = []
    current, screening = base, first
    for number in range(work.forward):
        order = sorted(screening.gains, key=lambda name: -screening.gains[name])[: work.survivors]
        fits: dict[str, Fit] = {}
        for index, name in enumerate(order):
            report(f"fitting {name}", 0.55 + 0.35 * (number + index / len(order)) / work.forward)
            effect = next(effect for effect in effects if effect.name == name)
            if name in screening.best:
                fits[name] = fit_effect(fitter, screening, effect, effects, work.steps)
        if not fits:
            break
        step = Step(screening, fits, rival_weights(fits, fitter.least), 1.0)
        best = fits[step.best]
        step = replace(step, p_value=null.p_value(min(step.gain, max(screening.gains.values()) * 2 + 1)))
        real = step.p_value < LEVEL and step.gain > LEAST_GAIN and matters(features, current, best)
        steps.append(step)
        if not real:
            break
        current = best
        if number + 1 < work.forward:
            screening = screen(fitter, current, effects)
    report("weighing the answer", 0.95)
    diagnosis = _verdict(evidence, features, fitter, views, base, current, floor, null, steps, scatter)
    diagnosis.detectable = detectable_amplitudes(first, effects, max(float(np.quantile(null.gains, 0.95)), LEAST_GAIN))
    diagnosis.seconds = time.perf_counter() - began
    return diagnosis


def _taken(steps: list[Step], final: Fit) -> list[Step]:
    return [step for step in steps if step.best in final.candidate.effects]


def _verdict(
    evidence: Evidence,
    features: Features,
    fitter: Fitter,
    views: Views,
    base: Fit,
    final: Fit,
    floor: Array,
    null: Null,
    steps: list[Step],
    scatter: RepetitionScatter,
) -> Diagnosis:
    taken = _taken(steps, final)
    own_floor = np.minimum(features.floor(final.features), floor)
    excess = ratio(features, final, own_floor) / null.limit()
    adequate = bool(np.all(excess[[0, 1, 2, 3]] < 1.0)) and excess[4] < 1.4
    ranked = rank_drivers(features, final, own_floor)
    p_value = steps[0].p_value if steps else 1.0
    answer: dict[str, Any] = {
        "p_value": p_value, "baseline": base, "final": final, "floor": own_floor, "null": null, "steps": steps,
        "features": features, "fitter": fitter, "scatter": scatter, "seconds": 0.0, "exploratory": not evidence.repeated,
    }  # fmt: skip
    lacking = what_is_lacking(evidence)
    if lacking:
        return Diagnosis("cannot_tell", [], [], reason=lacking, **answer)
    if not adequate:
        worst = CHANNELS[int(np.argmax(excess))]
        reason = f"the best model leaves {float(np.max(excess * null.limit())):.2f} x floor in {worst}"
        return Diagnosis("outside_library", [], top_drivers(ranked), reason=reason, **answer)
    if not taken:
        reason = "no effect gains more than in twins with nothing missing"
        return Diagnosis("nothing_missing", [], [], reason=reason, **answer)
    for step in taken:
        rivals = [name for name, weight in step.weights.items() if weight > 0.5 * (1 - POSTERIOR)]
        if step.weights[step.best] < POSTERIOR and len(rivals) > 1:
            rivals.sort(key=lambda name: -step.weights[name])
            reason = "these tests fit them alike"
            return Diagnosis("one_of", rivals, [], reason=reason, **answer)
    names = [step.best for step in taken]
    return Diagnosis("effect", names, [], reason="the error falls to its floor", **answer)


def what_is_lacking(evidence: Evidence) -> str:
    """Return what the tests lack for any verdict, or an empty string."""
    moving = [test for test in evidence.tests if np.ptp(test.arm) > 20 * math.pi / 180]
    if len(evidence.tests) < 3:
        return f"{len(evidence.tests)} test(s); at least 3 are needed, better several conditions with 3 repetitions each"
    if len(evidence.conditions) < 2:
        return "one condition only: one preload, one speed; most effects look alike here"
    if len(moving) < 2:
        return "the arm hardly moves in these tests"
    return ""
