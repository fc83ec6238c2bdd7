"""Fit unknowns to the views: Gauss-Newton steps on the logarithm of each test's error, from one start or several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import STEP, Unknown, base_unknowns, read, surprise, written
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features, log_error
from hjcamp.plants.pump_joint.diagnosis.residuals.memo import Recent
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
# A fit begins where the one before has ended, and a screening is about what was fitted last.
LOOKED, DIFFERED = 2, 4


@dataclass(frozen=True)
class Fit:
    """A fitted candidate: its loss, features (blocks, channels) and mean square error (tests, channels)."""

    candidate: Candidate
    loss: float
    features: Array
    mean_square: Array


@dataclass(frozen=True)
class Fitter:
    """Fits candidates on the tests in ``train`` (all by default); ``least`` (channels,) bounds what a test can gain."""

    views: Views
    features: Features
    least: Array
    train: tuple[int, ...] = ()
    windows: bool = True
    looked: Recent[Array] = field(default_factory=lambda: Recent(LOOKED), compare=False, repr=False)
    differed: Recent[Array] = field(default_factory=lambda: Recent(DIFFERED), compare=False, repr=False)

    @property
    def crew(self) -> Crew:
        """Who does the work."""
        return self.views.crew

    @property
    def rows(self) -> NDArray[np.int64]:
        """The tests that count."""
        return np.array(self.train or range(len(self.views.evidence.tests)))

    def smooth(self) -> Fitter:
        """Return a fitter that leaves the windows out: slips answer too wildly for the first steps."""
        least = self.least.copy()
        least[:2] = 1e12
        return replace(self, least=least, windows=False)

    def look(self, candidate: Candidate) -> Fit:
        """Return the loss of a candidate as it is."""
        key = (self.windows, candidate.key)
        return self.weighed(candidate, self.looked.get(key, lambda: self._seen(candidate)))

    def weighed(self, candidate: Candidate, features: Array) -> Fit:
        """Return the loss of a candidate with these features."""
        mean_square = self.features.mean_square(features)
        if not np.all(np.isfinite(mean_square)):
            mean_square = np.full_like(mean_square, 1e30)
        known = surprise(candidate, base_unknowns())
        loss = log_error(mean_square[self.rows], self.least) + float(known @ known)
        return Fit(candidate, loss, features, mean_square)

    def _seen(self, candidate: Candidate) -> Array:
        return self.features.of(self.views.residuals(candidate, self.windows))

    def jacobian(self, at: Fit, unknowns: Sequence[Unknown]) -> Array:
        """Return forward differences (unknowns, blocks, channels); a place at its bound is moved inwards."""
        key = (self.windows, at.candidate.key, tuple((unknown.effect, unknown.name) for unknown in unknowns))
        return self.differed.get(key, lambda: self._differences(at, unknowns))

    def _differences(self, at: Fit, unknowns: Sequence[Unknown]) -> Array:
        places = read(at.candidate, unknowns)

        def column(index: int) -> Array:
            moved = places.copy()
            moved[index] += STEP
            if unknowns[index].back(moved[index]) >= unknowns[index].parameter.bounds[1]:
                moved[index] -= 2 * STEP
            features = self._seen(written(at.candidate, unknowns, moved))
            return (features - at.features) / (moved[index] - places[index])

        return np.nan_to_num(np.array(list(self.crew.together(column, range(len(unknowns))))))

    def weights(self, mean_square: Array) -> Array:
        """Return the weight (blocks, channels) of each feature: one over its test's error, tests counting alike."""
        each = 1.0 / ((mean_square + self.least**2) * self.features.counts)
        mask = np.zeros(len(each))
        mask[self.rows] = 1.0
        return np.asarray((each * mask[:, None])[self.features.of_test])

    def fit(self, start: Candidate, unknowns: Sequence[Unknown], steps: int = 8, enough: float = 0.02) -> Fit:
        """Return the fit from ``start``: damped Gauss-Newton steps until the loss falls by less than ``enough``."""
        best = self.look(start)
        damping = 1e-2
        for _ in range(steps):
            jacobian = self.jacobian(best, unknowns)
            weights = self.weights(best.mean_square)
            flat = (jacobian * np.sqrt(weights)).reshape(len(unknowns), -1)
            gram = flat @ flat.T
            spread = np.array([unknown.spread for unknown in unknowns])
            gram[np.diag_indices(len(gram))] += spread**-2.0
            slope = flat @ (np.sqrt(weights) * best.features).ravel() + surprise(best.candidate, unknowns) / spread
            places = read(best.candidate, unknowns)
            before = best.loss
            for _ in range(5):
                lift = damping * np.diag(np.diag(gram)) + 1e-9 * np.trace(gram) * np.eye(len(gram))
                move = -np.linalg.solve(gram + lift, slope)
                size = np.max(np.abs(move))
                move *= min(1.0, 0.7 / size) if size > 0 else 1.0
                trial = self.look(written(best.candidate, unknowns, places + move))
                if trial.loss < best.loss:
                    best = trial
                    damping = max(damping / 5, 1e-4)
                    break
                damping *= 6
            if before - best.loss < enough:
                break
        centred = self.views.centred(best.candidate)
        if centred is best.candidate:
            return best
        seen = self.look(centred)
        return seen if seen.loss < best.loss + enough else best
