"""Fit quantities to a table: least squares from several starts, then, for long searches, an evolution strategy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.tables.cells import Cells, robust, weights
from hjcamp.plants.pump_joint.tables.quantities import quantities_of, settings_of, surprise
from hjcamp.plants.pump_joint.tables.rig import Rig

Array = NDArray[np.float64]
#: Half the first and half the last step of a slope: breakaways make small ones rough, long ones are no slope.
WIDEST, NARROWEST = 0.15, 0.05
#: Damping in shares of each quantity's own weight (Marquardt 1963): at the start, its change from trial to trial, and how
#: many trials a slope is good for; the last step is then a hundredth of the first.
DAMPING, EASED, TRIALS = 0.01, 10.0, 5
#: A fall of the loss by less than this is none; 2 is what one further quantity has to bring.
SMALL = 0.2


@dataclass(frozen=True)
class Fit:
    """A fitted model: the candidates it has, the places of its quantities by name, its loss with what its moves cost."""

    names: tuple[str, ...]
    places: Mapping[str, float]
    loss: float

    @property
    def settings(self) -> dict[str, float]:
        """The settings of the rig."""
        quantities = quantities_of(self.names)
        return settings_of(quantities, np.array([self.places[one.name] for one in quantities]))

    @property
    def surprise(self) -> float:
        """What the moves away from what is known cost."""
        quantities = quantities_of(self.names)
        return surprise(quantities, np.array([self.places[one.name] for one in quantities]))

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        return {"names": list(self.names), "places": dict(self.places), "loss": self.loss}

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Fit:
        """Return the fit of plain values."""
        return cls(tuple(found["names"]), dict(found["places"]), float(found["loss"]))


@dataclass
class Fitting:
    """The error of a rig's cells against a table, for the quantities of one model; ``count`` tables were simulated."""

    rig: Rig
    cells: Cells
    names: Sequence[str]
    count: int = field(default=0)

    def __post_init__(self) -> None:
        self.quantities = quantities_of(self.names)
        self.low, self.high = np.array([one.ends for one in self.quantities]).T
        self.known = np.array([1.0 / one.spread for one in self.quantities])
        self.start = np.array([one.start for one in self.quantities])

    def begun(self, start: Mapping[str, float]) -> Array:
        """Return the places of ``start``; what it does not name begins as published."""
        return np.array([float(start.get(one.name, one.start)) for one in self.quantities])

    def errors(self, places: Array) -> Array:
        """Return the normalised error of each cell."""
        self.count += 1
        return self.cells.errors(self.cells.of(self.rig.indicators(settings_of(self.quantities, places))))

    def loss(self, errors: Array, places: Array) -> float:
        """Return the robust error of the cells and the cost of the moves away from what is known."""
        return float(robust(errors).sum()) + surprise(self.quantities, places)

    def slopes(self, places: Array, half: float) -> Array:
        """Return the change of each error (cells, quantities) by each quantity, over ``half`` to both sides, within bounds."""
        found = []
        for index in range(len(places)):
            ends = np.tile(places, (2, 1))
            ends[:, index] = np.clip(places[index] + np.array([-half, half]), self.low[index], self.high[index])
            below, above = (self.errors(end) for end in ends)
            found.append((above - below) / (ends[1, index] - ends[0, index]))
        return np.array(found).T

    def descended(self, places: Array, budget: int) -> tuple[Array, float]:
        """Return where damped least squares with the weights of the robust loss ends, and the loss there.

        Slopes are kept along a descent by secants (Broyden) and simulated again, over less, where it comes to a stop.
        Source: Marquardt (1963), J. SIAM 11, 431; Broyden (1965), Math. Comp. 19, 577; Holland & Welsch (1977), Communications in
        Statistics A6, 813.
        """
        places = np.clip(places, self.low, self.high)
        errors = self.errors(places)
        lowest, half, damping = self.loss(errors, places), WIDEST, DAMPING
        slopes, fresh, last = self.slopes(places, half), True, self.count + budget
        while self.count < last:
            before = lowest
            for _ in range(TRIALS):
                point = np.clip(places + self._step(slopes, errors, places, damping), self.low, self.high)
                there, move = self.errors(point), point - places
                loss = self.loss(there, point)
                if loss < lowest:
                    slopes = slopes + np.outer(there - errors - slopes @ move, move) / (move @ move)
                    places, errors, lowest, damping = point, there, loss, damping / EASED
                    break
                damping *= EASED
            if before - lowest >= SMALL:
                fresh = False
                continue
            if fresh:
                half /= 2
            if half < NARROWEST:
                break
            slopes, fresh, damping = self.slopes(places, half), True, DAMPING
        return places, lowest

    def _step(self, slopes: Array, errors: Array, places: Array, damping: float) -> Array:
        root = np.sqrt(weights(errors))
        weighed = slopes * root[:, None]
        free = np.sqrt(damping * ((weighed**2).sum(axis=0) + self.known**2))
        left = np.vstack([weighed, np.diag(self.known), np.diag(free)])
        right = np.concatenate([-errors * root, (self.start - places) * self.known, np.zeros(len(places))])
        return np.asarray(np.linalg.lstsq(left, right, rcond=None)[0])

    def evolved(self, places: Array, lowest: float, budget: int, seed: int) -> tuple[Array, float]:
        """Return the best of an evolution strategy about ``places``: it passes over the steps that breakaways make.

        It begins as wide as the slopes, and less where the cells are judged by less: the bottom is narrower there.
        Source: Hansen (2016), The CMA Evolution Strategy: a Tutorial, arXiv:1604.00772.
        """
        best, strategy = places, CMA(places.copy(), WIDEST * self.cells.form, seed=seed)
        for _ in range(budget // strategy.population_size):
            asked = [strategy.ask() for _ in range(strategy.population_size)]
            points = [np.clip(point, self.low, self.high) for point in asked]
            losses = [self.loss(self.errors(point), point) for point in points]
            strategy.tell(list(zip(asked, losses, strict=True)))
            place = int(np.argmin(losses))
            if losses[place] < lowest:
                best, lowest = points[place], losses[place]
            if strategy.should_stop():
                break
        return best, lowest


def fit(
    rig: Rig,
    cells: Cells,
    names: Sequence[str],
    starts: Sequence[Mapping[str, float]],
    budget: int,
    seed: int,
    polish: int = 0,
) -> Fit:
    """Return the best fit from the best of ``starts`` with about ``budget`` simulated tables, then with ``polish`` more.

    Quantities without a place in a start begin as published.
    """
    fitting = Fitting(rig, cells, names)
    begins = [fitting.begun(start) for start in starts]
    begin = min(begins, key=lambda one: fitting.loss(fitting.errors(one), one)) if len(begins) > 1 else begins[0]
    best, lowest = fitting.descended(begin, budget)
    if polish:
        best, lowest = fitting.evolved(best, lowest, polish, seed)
    values = {one.name: float(value) for one, value in zip(fitting.quantities, best, strict=True)}
    return Fit(tuple(names), values, lowest)
