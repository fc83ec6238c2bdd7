"""What a rival looks like on some tests, what its unknowns do there, and what a linear refit of them leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import read, written
from hjcamp.plants.pump_joint.diagnosis.screening.normal_equations import Gram, project
from hjcamp.plants.pump_joint.diagnosis.screening.responses import amplitudes
from hjcamp.plants.pump_joint.diagnosis.screening.screening import unknowns_of

Array = NDArray[np.float64]
ROUNDS = 3
UNIT_SPREAD = 1.0
ALLOWED = 2.0


@dataclass(frozen=True)
class Products:
    """Of one rival on some tests: products of its responses, of its residual with them, its mean square, its unknowns' priors."""

    products: Array
    cross: Array
    square: Array
    stiff: Array

    def rows(self, chosen: Sequence[int]) -> Products:
        """Return those of some tests."""
        index = list(chosen)
        return Products(self.products[index], self.cross[index], self.square[index], self.stiff)

    def beside(self, other: Products) -> Products:
        """Return those of both sets of tests."""
        return Products(
            np.concatenate([self.products, other.products]),
            np.concatenate([self.cross, other.cross]),
            np.concatenate([self.square, other.square]),
            self.stiff,
        )

    def losses(self, least: Array, weight: Array) -> Array:
        """Return the loss (tests,) after the refit on all these tests, each counted ``weight`` (tests,) times."""
        own = np.arange(len(self.stiff))
        free = np.zeros(len(own), dtype=np.bool_)
        stiff, pull = np.diag(self.stiff), np.zeros((1, len(own)))
        return project(self.products, self.cross[None], self.square[None], least, own, free, stiff, pull, weight, ROUNDS)[0][0]


@dataclass(frozen=True)
class Responses:
    """Of one rival on the fitter's tests: how it looks there, and the products of the responses of its unknowns."""

    seen: Fit
    gram: Gram
    stiff: Array

    @classmethod
    def of(cls, fitter: Fitter, candidate: Candidate, effects: Sequence[type[Effect]]) -> Responses:
        """Return the responses of a candidate's base and effect parameters."""
        seen = fitter.look(candidate)
        unknowns = unknowns_of(candidate, effects)
        gram = Gram.of(fitter.jacobian(seen, unknowns), fitter.features, fitter.least)
        # Beyond one unit of the fitted scale a response is no longer what it was: no refit may go far.
        spread = np.minimum([unknown.spread for unknown in unknowns], UNIT_SPREAD)
        return cls(seen, gram, np.asarray(spread**-2.0))

    def largest(self, effects: Sequence[type[Effect]]) -> Candidate:
        """Return the candidate with its effect as large as these tests still allow, and the base moved along with it.

        Two standard deviations up, tests counting alike: a test is worth what it shows of an effect that is there, and a
        rival that the tests so far hardly touch has been fitted with next to nothing.
        """
        candidate = self.seen.candidate
        unknowns = unknowns_of(candidate, effects)
        linear = {effect.name: amplitudes(effect) for effect in effects}
        places = [k for k, one in enumerate(unknowns) if one.effect and one.name in linear[one.effect]]
        if not places:
            return candidate
        weight = 1.0 / (self.seen.mean_square + self.gram.least**2)
        information = np.einsum("tcij,tc->ij", self.gram.products, weight) + np.diag(self.stiff)
        covariance = np.linalg.inv(information)
        best = max(places, key=lambda k: information[k, k])
        now = read(candidate, unknowns)
        sign = -1.0 if now[best] < 0.0 and not unknowns[best].logarithmic else 1.0
        move = ALLOWED * sign * covariance[:, best] / np.sqrt(covariance[best, best])
        return written(candidate, unknowns, now + np.clip(move, -ALLOWED, ALLOWED))

    def products(self, residual: Array | None = None) -> Products:
        """Return the products with the rival's own residual, or with another one (blocks, channels)."""
        cross, square = self.gram.with_residual(np.nan_to_num(self.seen.features if residual is None else residual))
        return Products(self.gram.products, cross, square, self.stiff)
