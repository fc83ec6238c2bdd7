"""What a diagnosis would find were nothing missing: the same search on simulated twins of the user's own campaign."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.bootstrap.surrogates import make_twin
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.levels import margin
from hjcamp.plants.pump_joint.diagnosis.measured.repetition import RepetitionScatter
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.screening.normal_equations import Known, gains_of_each, project
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Screening

Array = NDArray[np.float64]
JUDGED = 5


@dataclass(frozen=True)
class Null:
    """Twins of one model: the largest gain of each (twins,), and the logarithm of its errors (twins, tests, channels).

    ``says`` (tests, channels) is where a test says anything in a channel; ``residuals`` are what the model leaves of each twin.
    """

    gains: Array
    logarithms: Array
    says: NDArray[np.bool_]
    least: Array
    residuals: Sequence[Array] = ()

    def p_value(self, gain: float) -> float:
        """Return how often a twin gains as much."""
        return float((1 + np.sum(self.gains >= gain)) / (1 + len(self.gains)))

    def needed(self) -> float:
        """Return the gain that only one twin in twenty exceeds."""
        return float(np.quantile(self.gains, 0.95))

    def over(self, mean_square: Array) -> Array:
        r"""Return the error over that of the twins (channels,), tests counting alike.

        .. math:: r_c = \exp \tfrac12 \bigl\langle \log(e^2_{tc} + l_c^2)
                  - \overline{\log(e^2_{tc} + l_c^2)}^{twins} \bigr\rangle_t
        """
        return self._mean(np.log(mean_square + self.least**2) - self.logarithms.mean(axis=0))

    def _mean(self, difference: Array) -> Array:
        counts = np.maximum(self.says.sum(axis=0), 1)
        return np.asarray(np.exp(0.5 * np.where(self.says, difference, 0.0).sum(axis=0) / counts))

    def limit(self) -> Array:
        """Return the error over that of the twins (channels,) that may be left: that of 95 % of them, times the margin of rigs
        with other contacts."""
        return self.highest() * margin()

    def highest(self) -> Array:
        """Return the error over that of the others (channels,) that 95 % of the twins stay below."""
        return np.asarray(np.quantile(self._own, 0.95, axis=0))

    def spread(self) -> Array:
        """Return the standard deviation (channels,) of the logarithm of the twins' errors over that of the others."""
        return np.asarray(np.std(np.log(self._own), axis=0, ddof=1))

    @cached_property
    def _own(self) -> Array:
        """The error of each twin over that of the others (twins, channels)."""
        count = len(self.logarithms)
        others = (self.logarithms.sum(axis=0) - self.logarithms) / max(count - 1, 1)
        return np.array([self._mean(one - rest) for one, rest in zip(self.logarithms, others, strict=True)])

    def excess(self, before: Array, after: Array, law: float) -> Array:
        """Return the error (channels,) over what may be left: 1 and less is as good as the twins.

        ``before`` and ``after`` (tests, channels) are mean squares without and with the named effects. A law may be off
        by the share ``law`` of the effect itself, since another joint's leak has another shape (`levels.law`); 0 for exact laws.
        """
        first, left = self.over(before), self.over(after)
        allowed = np.sqrt(self.limit() ** 2 + law**2 * np.maximum(first**2 - left**2, 0.0))
        return np.asarray((left / allowed)[:JUDGED])


def simulate_twins(
    fitter: Fitter, fit: Fit, scatter: RepetitionScatter, seeds: list[int], tick: Callable[[], None] = lambda: None
) -> list[Array]:
    """Return what the fitted model leaves (blocks, channels) of twins of itself, one for each seed."""
    residuals = []
    for residual in fitter.crew.each(_one_twin, (fitter.views, fitter.features, fit, scatter), seeds):
        residuals.append(residual)
        tick()
    return residuals


def null_of(fitter: Fitter, screening: Screening, residuals: list[Array]) -> Null:
    """Return what a screening finds in the residuals of twins in which nothing is missing.

    What is known beforehand of a rig is off by its spread in each twin, as it is from rig to rig. Without twins there is
    no null: nothing can be asked of it.
    """
    if not residuals:
        shape = len(fitter.views.evidence.tests), len(fitter.least)
        return Null(np.zeros(0), np.zeros((0, *shape)), np.zeros(shape, dtype=np.bool_), fitter.least)
    gains, errors = _found_in(screening, np.array(residuals))
    features = fitter.features
    says = np.add.reduceat(features.valid, features.edges[:-1], axis=0) > 0
    logarithms = np.log(errors + fitter.least**2)
    tells = np.array([features.mean_square(residual) > 0.0 for residual in residuals])
    return Null(gains, of_those_that_tell(logarithms, tells), says & tells.any(axis=0), fitter.least, residuals)


def of_those_that_tell(logarithms: Array, tells: NDArray[np.bool_]) -> Array:
    """Return the logarithms (twins, tests, channels), the mean of the others where a twin does not tell, as it rests there."""
    number = np.maximum(tells.sum(axis=0), 1)
    return np.where(tells, logarithms, np.where(tells, logarithms, 0.0).sum(axis=0) / number)


def _one_twin(context: tuple[Views, Features, Fit, RepetitionScatter], seed: int) -> Array:
    views, features, fit, scatter = context
    copied = make_twin(views, fit.candidate, scatter, seed)
    own = Features(copied)
    found = own.of(Views(copied, views.effects, views.crew).residuals(fit.candidate))
    return features.shared(own, found)


def _found_in(screening: Screening, residuals: Array) -> tuple[Array, Array]:
    """Return the largest gain (twins,) in each twin, and the mean squares (twins, tests, channels) that the unknowns already
    in the model leave of ``residuals`` (twins, blocks, channels)."""
    gram, stiff = screening.gram, screening.known.stiff
    cross, square = gram.with_residuals(residuals)
    gains = np.zeros(len(residuals))
    if screening.probes:
        spread = np.divide(1.0, np.sqrt(stiff), out=np.zeros_like(stiff), where=stiff > 0.0)
        away = [np.random.default_rng(number).standard_normal(len(stiff)) for number in range(len(residuals))]
        known = Known(stiff, spread * np.array(away))
        gains = gains_of_each(gram, cross, square, known, screening.groups)[0].max(axis=1)
    return gains, errors_beside_known(screening, cross, square)


def errors_beside_known(screening: Screening, cross: Array, square: Array) -> Array:
    """Return the mean squares (twins, tests, channels) that the unknowns already in the model cannot take up."""
    gram, count = screening.gram, len(screening.unknowns)
    free, every = np.zeros(count, dtype=np.bool_), np.ones(square.shape[1])
    stiff, pull = np.diag(screening.known.stiff), np.zeros((len(square), count))
    return project(gram.products, cross, square, gram.least, np.arange(count), free, stiff, pull, every, 3)[2]
