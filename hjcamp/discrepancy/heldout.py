"""Judge fits on tests that were not used for them, and give their parameters honest intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.evidence import Evidence
from hjcamp.discrepancy.features import Features
from hjcamp.discrepancy.fit import Fit, Fitter
from hjcamp.discrepancy.unknowns import Unknown, read
from hjcamp.discrepancy.views import Candidate

Array = NDArray[np.float64]
JUDGED = 5


@dataclass(frozen=True)
class Fold:
    """A division of the tests: those that are fitted and those that judge."""

    train: tuple[int, ...]
    held_out: tuple[int, ...]


def folds(evidence: Evidence, count: int) -> list[Fold]:
    """Return up to ``count`` divisions, each holding out one repetition of every repeated condition, the last first.

    Where nothing was repeated, whole conditions are held out instead.
    """
    conditions = list(evidence.conditions.values())
    found: list[Fold] = []
    if evidence.repeated:
        most = max(len(tests) for tests in conditions)
        for number in range(min(count, most)):
            out = {tests[-1 - number % len(tests)] for tests in conditions if len(tests) > 1}
            found.append(_fold(evidence, out))
    else:
        for number in range(min(count, len(conditions))):
            found.append(_fold(evidence, set(conditions[-1 - number])))
    return [fold for fold in found if fold.train]


def _fold(evidence: Evidence, out: set[int]) -> Fold:
    every = range(len(evidence.tests))
    return Fold(tuple(index for index in every if index not in out), tuple(sorted(out)))


def judged_error(features: Features, mean_square: Array, floor: Array, tests: Sequence[int]) -> float:
    """Return the error of some tests over the floor: root mean square over arm, pressures, line cut and sliding force."""
    rows = list(tests)
    counts = features.counts[rows]
    total = np.sqrt((mean_square[rows] * counts).sum(axis=0) / counts.sum(axis=0))
    over = (total / np.maximum(floor, 1e-30))[:JUDGED]
    return float(np.sqrt(np.mean(over**2)))


def heldout_error(
    fitter: Fitter, start: Candidate, unknowns: Sequence[Unknown], parts: Sequence[Fold], floor: Array
) -> float:
    """Return the held-out error of a model: refitted from ``start`` on each fold's train tests, judged on the others."""
    errors = []
    for fold in parts:
        own = replace(fitter, train=fold.train)
        fit = own.fit(start, unknowns, steps=2, enough=0.1)
        errors.append(judged_error(fitter.features, fit.mean_square, floor, fold.held_out))
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")


def intervals(
    fitter: Fitter, fit: Fit, unknowns: Sequence[Unknown]
) -> dict[tuple[str, str], tuple[float, float, float]]:
    r"""Return (value, low, high) of every unknown by (effect, name): 95 % intervals, SI.

    .. math:: \mathrm{cov} = \frac{T}{T-1} H^{-1} \Bigl(\sum_t g_t g_t^T\Bigr) H^{-1}

    with the test as the unit of evidence (sandwich; Huber 1967), T tests, Student's t with T - 1 degrees of freedom.
    """
    from scipy.stats import t as student

    jacobian = fitter.jacobian(fit, unknowns)
    weights = fitter.weights(fit.mean_square)
    weighted = jacobian * weights
    count = len(unknowns)
    known = np.array([unknown.spread for unknown in unknowns]) ** -2.0
    hessian = np.einsum("ibc,jbc->ij", weighted, jacobian) + np.diag(known)
    slopes = (weighted * fit.features).sum(axis=2)
    edges = fitter.features.edges
    each = np.array([slopes[:, a:b].sum(axis=1) for a, b in pairwise(edges)])[fitter.rows]
    each = each - each.mean(axis=0)
    tests = len(each)
    # What was known beforehand is evidence too: its own score scatters by its inverse variance.
    middle = each.T @ each * tests / max(tests - 1, 1) + np.diag(known)
    inverse = np.linalg.pinv(hessian + 1e-9 * np.trace(hessian) / count * np.eye(count))
    deviation = np.sqrt(np.maximum(np.diag(inverse @ middle @ inverse), 0.0))
    wide = float(student.ppf(0.975, max(tests - 1, 1))) * deviation
    places = read(fit.candidate, unknowns)
    found = {}
    for unknown, place, half in zip(unknowns, places, wide, strict=True):
        found[unknown.effect, unknown.name] = (
            unknown.back(float(place)), unknown.back(float(place - half)), unknown.back(float(place + half)),
        )  # fmt: skip
    return found


def parameter_rows(
    found: Mapping[tuple[str, str], tuple[float, float, float]], unknowns: Sequence[Unknown], effect: str
) -> dict[str, dict[str, Any]]:
    """Return the parameters of one effect ('' for the base) as rows of an answer: value, unit, ci95."""
    rows: dict[str, dict[str, Any]] = {}
    for unknown in unknowns:
        if unknown.effect == effect:
            value, low, high = found[effect, unknown.name]
            rows[unknown.name] = {"value": value, "unit": unknown.parameter.unit, "ci95": [low, high]}
    return rows
