"""Judge fits on tests that were not used for them, and give their parameters honest intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.levels.forms import form_of
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import Unknown, read, surprise, written
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import HOME

Array = NDArray[np.float64]
JUDGED = 5
LEAST_CONDITIONS = 5
MOST_MOVE = 1.0


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


def judged_error(features: Features, mean_square: Array, noise_floor: Array, tests: Sequence[int]) -> float:
    """Return the error of some tests over the floor: root mean square over arm, pressures, line cut, sliding force (where
    the arm slides in any test) and, where one of them tells it, where they begin."""
    rows = list(tests)
    counts = features.counts[rows]
    total = np.sqrt((mean_square[rows] * counts).sum(axis=0) / counts.sum(axis=0))
    over = total / np.maximum(noise_floor, 1e-30)
    judged = over[:JUDGED][noise_floor[:JUDGED] > 0.0]
    begins = np.isfinite(features.evidence.homes[rows])
    if begins.any():
        over[HOME] = np.sqrt(mean_square[rows, HOME][begins].mean()) / max(noise_floor[HOME], 1e-30)
        return float(np.sqrt(np.mean(np.append(judged, over[HOME]) ** 2)))
    return float(np.sqrt(np.mean(judged**2)))


@dataclass(frozen=True)
class Local:
    """A fit with its Jacobian (unknowns, blocks, channels): what held-out errors and intervals need.

    ``known`` is the Jacobian where it has been computed already.
    """

    fitter: Fitter
    fit: Fit
    unknowns: Sequence[Unknown]
    known: Array | None = None

    @cached_property
    def jacobian(self) -> Array:
        """Forward differences of the features."""
        return self.fitter.jacobian(self.fit, self.unknowns) if self.known is None else self.known

    def _system(self, fitter: Fitter) -> tuple[Array, Array, Array]:
        """Return weighted Jacobian, Hessian and slope of the loss on the tests of ``fitter``."""
        weighted = self.jacobian * fitter.weights(self.fit.mean_square)
        spread = np.array([unknown.spread for unknown in self.unknowns])
        count = len(self.unknowns)
        hessian = weighted.reshape(count, -1) @ self.jacobian.reshape(count, -1).T + np.diag(spread**-2.0)
        hessian += 1e-6 * np.diag(np.diag(hessian)) + 1e-9 * np.trace(hessian) / count * np.eye(count)
        slope = (weighted * self.fit.features).sum(axis=(1, 2)) + surprise(self.fit.candidate, self.unknowns) / spread
        return weighted, hessian, slope

    @cached_property
    def _refits(self) -> dict[tuple[int, ...], Fit]:
        return {}

    def refitted(self, train: tuple[int, ...]) -> Fit:
        """Return the fit on some of the tests alone: a Gauss-Newton step from here, halved where it overshoots."""
        if train not in self._refits:
            self._refits[train] = self._refit(train)
        return self._refits[train]

    def _refit(self, train: tuple[int, ...]) -> Fit:
        fitter = replace(self.fitter, train=train)
        here = fitter.weighed(self.fit.candidate, self.fit.features)
        _, hessian, slope = self._system(fitter)
        move = -np.linalg.solve(hessian, slope)
        move *= min(1.0, 0.5 / max(float(np.max(np.abs(move))), 1e-12))
        places = read(self.fit.candidate, self.unknowns)
        for factor in (1.0, 0.5, 0.25):
            trial = fitter.look(written(self.fit.candidate, self.unknowns, places + factor * move))
            if trial.loss < here.loss:
                return trial
        return here

    def heldout_error(self, parts: Sequence[Fold], noise_floor: Array) -> float:
        """Return the error of all residuals of tests left out, the model refitted without them; NaN without any fold.

        It weighs effects; what is told of errors is on the scale of `scale`, which has no forces and no windows.
        """
        errors = [
            judged_error(self.fitter.features, self.refitted(fold.train).mean_square, noise_floor, fold.held_out)
            for fold in parts
        ]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")

    def without(self, parts: Sequence[Fold]) -> list[Candidate]:
        """Return the candidate refitted without what each fold holds out."""
        return [self.refitted(fold.train).candidate for fold in parts]

    def _units(self) -> list[list[int]]:
        """Return the tests of each unit of evidence: the conditions, or the tests where there are few conditions."""
        rows = {int(row) for row in self.fitter.rows}
        groups = [[test for test in tests if test in rows] for tests in self.fitter.views.evidence.conditions.values()]
        groups = [group for group in groups if group]
        return groups if len(groups) >= LEAST_CONDITIONS else [[row] for row in sorted(rows)]

    def _moves(self, units: Sequence[Sequence[int]], weighted: Array, hessian: Array) -> Array:
        """Return by how much the unknowns move (units, unknowns) when one unit after the other is left out, linearised."""
        edges = self.fitter.features.edges
        count = len(self.unknowns)
        moves = []
        for unit in units:
            blocks = np.concatenate([np.arange(edges[test], edges[test + 1]) for test in unit])
            part = weighted[:, blocks]
            slope = (part * self.fit.features[blocks]).sum(axis=(1, 2))
            own = part.reshape(count, -1) @ self.jacobian[:, blocks].reshape(count, -1).T
            moves.append(np.clip(np.linalg.pinv(hessian - own) @ slope, -MOST_MOVE, MOST_MOVE))
        return np.array(moves)

    @cached_property
    def freedom(self) -> int:
        """The degrees of freedom of ``deviation``: the units of evidence but one."""
        return max(len(self._units()) - 1, 1)

    @cached_property
    def deviation(self) -> Array:
        """The standard deviation of each unknown (unknowns,) on the fitted scale, by the jackknife; see ``intervals``."""
        units = self._units()
        count = len(units)
        weighted, hessian, _ = self._system(self.fitter)
        moves = self._moves(units, weighted, hessian)
        moves = moves - moves.mean(axis=0)
        # What was known beforehand is evidence too: its own score scatters by its inverse variance.
        known = np.array([unknown.spread for unknown in self.unknowns]) ** -2.0
        inverse = np.linalg.pinv(hessian)
        return np.asarray(np.sqrt((moves**2).sum(axis=0) * (count - 1) / count + (inverse**2) @ known))

    @cached_property
    def sizes(self) -> Array:
        """What a share of the value of each unknown is on the fitted scale (unknowns,)."""
        places = read(self.fit.candidate, self.unknowns).tolist()
        return np.array([1.0 if one.logarithmic else abs(at) for one, at in zip(self.unknowns, places, strict=True)])

    @cached_property
    def _spread(self) -> Array:
        """The standard deviation of each unknown on the fitted scale with what the form of a law adds; see ``intervals``."""
        form = np.array([form_of(one.effect, one.name) for one in self.unknowns])
        return np.asarray(np.hypot(self.deviation, form * self.sizes))

    @property
    def standard_errors(self) -> Array:
        """The standard error of each unknown (unknowns,), SI."""
        places = read(self.fit.candidate, self.unknowns)
        sizes = [math.exp(at) if one.logarithmic else one.scale for one, at in zip(self.unknowns, places, strict=True)]
        return np.asarray(self._spread * np.array(sizes))

    @property
    def covariance(self) -> Array:
        """The inverse (unknowns, unknowns) of the loss's curvature, on the fitted scale."""
        return np.asarray(np.linalg.pinv(self._system(self.fitter)[1]))

    def intervals(self) -> dict[tuple[str, str], tuple[float, float, float]]:
        r"""Return (value, low, high) of every unknown by (effect, name): 95 % intervals, SI.

        .. math:: \mathrm{cov} = \frac{C-1}{C} \sum_c (\Delta_c - \bar\Delta)(\Delta_c - \bar\Delta)^T, \quad
                  \Delta_c = (H - H_c)^{-1} g_c

        with the condition as the unit of evidence, left out one after the other (jackknife; Bell & McCaffrey 2002, Survey
        Methodology 28(2), 169-181): what a model gets wrong about a condition it gets wrong in each of its repetitions,
        and one condition alone may tell a parameter. C conditions, Student's t with C - 1 degrees of freedom; with fewer
        than five conditions the test is the unit. What the form of a law adds is what rigs with other laws and contacts show
        (`levels.forms`): no number of tests of one rig tells it.
        """
        from scipy.special import stdtrit

        places = read(self.fit.candidate, self.unknowns)
        wide = float(stdtrit(self.freedom, 0.975)) * self._spread
        return {
            (one.effect, one.name): (one.back(place), one.back(place - half), one.back(place + half))
            for one, place, half in zip(self.unknowns, places.tolist(), wide.tolist(), strict=True)
        }


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
