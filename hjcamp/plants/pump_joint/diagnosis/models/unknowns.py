"""What is fitted: base parameters and parameters of effects, each on a scale where steps of equal size matter equally."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint import PumpJoint

Array = NDArray[np.float64]
STEP = 0.06


@dataclass(frozen=True)
class Unknown:
    """One fitted parameter; ``effect`` is empty for a base parameter. Positive ones move on a logarithmic scale.

    ``spread`` is the standard deviation (on the fitted scale) with which its published value is known beforehand.
    """

    effect: str
    name: str
    parameter: Parameter
    spread: float = math.inf

    @property
    def logarithmic(self) -> bool:
        """Whether it is fitted as its logarithm."""
        return self.parameter.prior == "log-uniform"

    @property
    def scale(self) -> float:
        """Size of one unit of the fitted scale, for a linear one."""
        low, high = self.parameter.bounds
        if self.parameter.default != 0.0:
            return abs(self.parameter.default)
        return 0.1 * (high - low) if math.isfinite(high - low) else 1.0

    def forth(self, value: float) -> float:
        """Return ``value`` on the fitted scale."""
        return math.log(value) if self.logarithmic else value / self.scale

    def back(self, place: float) -> float:
        """Return the value of a place on the fitted scale, held within its bounds, or within a turn where it is cyclic."""
        low, high = self.parameter.bounds
        if self.parameter.cyclic:
            return math.remainder(place * self.scale, math.tau)
        value = math.exp(min(max(place, -700.0), 700.0)) if self.logarithmic else place * self.scale
        return min(max(value, low), high)


def base_unknowns(names: Iterable[str] | None = None) -> list[Unknown]:
    """Return the base parameters of the plant, then those that are known beforehand to within a spread."""
    chosen = names or (*PumpJoint.base_parameters, *PumpJoint.uncertain)
    found = []
    for name in chosen:
        unknown = Unknown("", name, PumpJoint.parameters[name])
        known = PumpJoint.uncertain.get(name, math.inf)
        found.append(replace(unknown, spread=known if unknown.logarithmic else known / unknown.scale))
    return found


def surprise(candidate: Candidate, unknowns: Sequence[Unknown]) -> Array:
    """Return how far each unknown is from what was known beforehand, in standard deviations (0 where nothing was)."""
    known = np.array([unknown.forth(unknown.parameter.default) for unknown in unknowns])
    return np.asarray((read(candidate, unknowns) - known) / np.array([unknown.spread for unknown in unknowns]))


def beside_known(candidate: Candidate, unknowns: Sequence[Unknown]) -> Array:
    """Return how far each unknown is from what was known beforehand, on the fitted scale (0 where nothing was)."""
    spread = np.array([unknown.spread for unknown in unknowns])
    return np.asarray(surprise(candidate, unknowns) * np.where(np.isfinite(spread), spread, 0.0))


def effect_unknowns(effect: type[Effect]) -> list[Unknown]:
    """Return the parameters of one effect that all tests share."""
    return [Unknown(effect.name, name, parameter) for name, parameter in effect.parameters.items() if not parameter.each_test]


def read(candidate: Candidate, unknowns: Sequence[Unknown]) -> Array:
    """Return the places of the unknowns in a candidate."""
    places = []
    for unknown in unknowns:
        group = candidate.effects.get(unknown.effect, {}) if unknown.effect else candidate.base
        places.append(unknown.forth(group.get(unknown.name, unknown.parameter.default)))
    return np.array(places)


def written(candidate: Candidate, unknowns: Sequence[Unknown], places: Array) -> Candidate:
    """Return the candidate with the unknowns at the given places; static friction never below Coulomb friction."""
    base = dict(candidate.base)
    effects = {name: dict(values) for name, values in candidate.effects.items()}
    for unknown, place in zip(unknowns, places, strict=True):
        if unknown.effect:
            effects.setdefault(unknown.effect, {})[unknown.name] = unknown.back(float(place))
        else:
            base[unknown.name] = unknown.back(float(place))
    for direction in ("positive", "negative"):
        static, coulomb = f"static_{direction}", f"coulomb_{direction}"
        if static in base and coulomb in base:
            base[static] = max(base[static], base[coulomb])
    return Candidate(base, effects)
