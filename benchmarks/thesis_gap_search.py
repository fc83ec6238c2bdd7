"""Fit base parameters, openings and effects to a table of indicators: evolution strategy, since slips answer wildly."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from thesis_gap_cells import Cells, robust
from thesis_gap_rig import OPENINGS, Rig

from hjcamp.effects import load_effects
from hjcamp.model.parameter import Parameter
from hjcamp.plants.pump_joint import PumpJoint

Array = NDArray[np.float64]
#: The same in every test of these tables, or the same thing as another parameter of its effect.
KNOWN = ("radius", "rest_before", "settled", "arm_share", "threshold")
#: How far the printed constants are trusted, on the scale on which they are fitted.
SPREAD = 0.35


@dataclass(frozen=True)
class Quantity:
    """One fitted number; ``positive`` ones move on a logarithmic scale, others as their prior or in units of their default."""

    name: str
    parameter: Parameter
    spread: float = math.inf
    positive: bool = False

    def forth(self, value: float) -> float:
        """Return ``value`` on the fitted scale."""
        return math.log(value) if self._logarithmic else value / self._unit

    def back(self, place: float) -> float:
        """Return the value of a place, held within its bounds."""
        low, high = self.parameter.bounds
        value = math.exp(min(place, 700.0)) if self._logarithmic else place * self._unit
        return min(max(value, low), high)

    @property
    def _logarithmic(self) -> bool:
        return self.positive or self.parameter.prior == "log-uniform"

    @property
    def _unit(self) -> float:
        low, high = self.parameter.bounds
        return abs(self.parameter.default) or 0.1 * (high - low)

    @property
    def start(self) -> float:
        """The place of the published value."""
        return self.forth(self.parameter.default)


def base_quantities() -> list[Quantity]:
    """Return the base parameters; static friction as its ratio to Coulomb friction, which is at least 1."""
    found = []
    for name in PumpJoint.base_parameters:
        parameter = PumpJoint.parameters[name]
        if name.startswith("static_"):
            side = name.removeprefix("static_")
            ratio = parameter.default / PumpJoint.parameters[f"coulomb_{side}"].default
            found.append(Quantity(f"drop_{side}", Parameter("1", ratio, (1.0, 4.0)), SPREAD))
        else:
            viscous = name.startswith("viscous")
            found.append(Quantity(name, parameter, 1.0 if viscous else SPREAD, positive=not viscous))
    return found


def candidate_quantities(name: str) -> list[Quantity]:
    """Return what a candidate adds to the base: one opening, or the parameters of one effect."""
    if name in OPENINGS:
        return [Quantity(name, OPENINGS[name], SPREAD)]
    effect = load_effects([])[name]
    return [Quantity(f"{name}.{key}", value) for key, value in effect.parameters.items() if key not in KNOWN]


def settings_of(quantities: Sequence[Quantity], places: Array) -> dict[str, float]:
    """Return the settings for these places; static friction from its ratio."""
    found = {quantity.name: quantity.back(float(place)) for quantity, place in zip(quantities, places, strict=True)}
    for side in ("positive", "negative"):
        ratio = found.pop(f"drop_{side}", None)
        if ratio is not None:
            found[f"static_{side}"] = ratio * found[f"coulomb_{side}"]
    return found


@dataclass(frozen=True)
class Fit:
    """A fitted table: the places of its quantities, and the loss (errors of the cells, surprise of the constants)."""

    quantities: Sequence[Quantity]
    places: Array
    loss: float

    @property
    def settings(self) -> dict[str, float]:
        """The settings of the rig."""
        return settings_of(self.quantities, self.places)


@dataclass(frozen=True)
class Task:
    """Which cells are to be met by which tests; ``kept`` leaves cells out, ``target`` replaces the printed means."""

    rig: Rig
    cells: Cells
    kept: NDArray[np.bool_] | None = None
    target: Array | None = None

    def errors(self, settings: dict[str, float]) -> Array:
        """Return the normalised error of every cell."""
        return self.cells.errors(self.cells.of(self.rig.indicators(settings)), self.target)

    def loss(self, quantities: Sequence[Quantity], places: Array) -> float:
        """Return the robust error of the kept cells plus what the move away from the printed constants costs."""
        errors = robust(self.errors(settings_of(quantities, places)))
        return float(errors.sum() if self.kept is None else errors[self.kept].sum()) + surprise(quantities, places)


def surprise(quantities: Sequence[Quantity], places: Array) -> float:
    """Return the squared distance of the quantities from the printed constants in units of their spread."""
    away = [(place - one.start) / one.spread for one, place in zip(quantities, places, strict=True)]
    return float(np.sum(np.square(away)))


def fit(task: Task, quantities: Sequence[Quantity], start: Array, width: float, budget: int, seed: int) -> Fit:
    """Return the best of an evolution strategy with adapted covariance of about ``budget`` simulated tables.

    Source: Hansen (2016), The CMA Evolution Strategy: a Tutorial, arXiv:1604.00772.
    """
    places, loss = evolve(lambda x: task.loss(quantities, x), start, width, budget, seed)
    return Fit(quantities, places, loss)


def evolve(loss: Callable[[Array], float], start: Array, width: float, budget: int, seed: int) -> tuple[Array, float]:
    """Return the best point and its loss; ``width`` is the first standard deviation in every direction."""
    generator = np.random.default_rng(seed)
    n = len(start)
    offspring = 4 + int(3 * np.log(n))
    parents = offspring // 2
    share = np.log(parents + 0.5) - np.log(np.arange(1, parents + 1))
    share /= share.sum()
    effective = 1.0 / np.sum(share**2)
    c_path, c_sigma = (4 + effective / n) / (n + 4 + 2 * effective / n), (effective + 2) / (n + effective + 5)
    c_one = 2 / ((n + 1.3) ** 2 + effective)
    c_mu = min(1 - c_one, 2 * (effective - 2 + 1 / effective) / ((n + 2) ** 2 + effective))
    damping = 1 + 2 * max(0.0, math.sqrt((effective - 1) / (n + 1)) - 1) + c_sigma
    usual = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))
    mean, sigma = np.array(start, dtype=float), width
    covariance, path, path_sigma = np.eye(n), np.zeros(n), np.zeros(n)
    best, lowest = mean.copy(), loss(mean)
    for generation in range(max(1, (budget - 1) // offspring)):
        root = np.linalg.cholesky(covariance + 1e-12 * np.eye(n))
        draws = generator.standard_normal((offspring, n))
        steps = draws @ root.T
        losses = np.array([loss(mean + sigma * step) for step in steps])
        order = np.argsort(losses)
        if losses[order[0]] < lowest:
            best, lowest = mean + sigma * steps[order[0]], float(losses[order[0]])
        chosen = steps[order[:parents]]
        mean = mean + sigma * (share @ chosen)
        path_sigma = (1 - c_sigma) * path_sigma + math.sqrt(c_sigma * (2 - c_sigma) * effective) * (
            share @ draws[order[:parents]]
        )
        length = float(np.linalg.norm(path_sigma))
        short = length / math.sqrt(1 - (1 - c_sigma) ** (2 * (generation + 1))) < (1.4 + 2 / (n + 1)) * usual
        path = (1 - c_path) * path + short * math.sqrt(c_path * (2 - c_path) * effective) * (share @ chosen)
        covariance = (1 - c_one - c_mu) * covariance + c_one * np.outer(path, path) + c_mu * (chosen.T * share) @ chosen
        covariance = 0.5 * (covariance + covariance.T)
        sigma *= math.exp(min(0.5, c_sigma / damping * (length / usual - 1)))
    return best, lowest
