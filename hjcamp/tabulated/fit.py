"""Fit quantities to a table: an evolution strategy, since breakaways make the error jump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray

from hjcamp.tabulated.cells import Cells, robust
from hjcamp.tabulated.quantities import quantities_of, settings_of, surprise
from hjcamp.tabulated.rig import Rig

Array = NDArray[np.float64]


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


def loss_of(rig: Rig, cells: Cells, names: Sequence[str], places: Array) -> float:
    """Return the robust error of the cells and the cost of the moves away from what is known."""
    quantities = quantities_of(names)
    simulated = cells.of(rig.indicators(settings_of(quantities, places)))
    return float(robust(cells.errors(simulated)).sum()) + surprise(quantities, places)


def fit(
    rig: Rig,
    cells: Cells,
    names: Sequence[str],
    starts: Sequence[Mapping[str, float]],
    budget: int,
    seed: int,
    width: float = 0.15,
) -> Fit:
    """Return the best of about ``budget`` simulated tables; it begins at the best of ``starts``.

    Quantities without a place in a start begin as published.

    Source: Hansen (2016), The CMA Evolution Strategy: a Tutorial, arXiv:1604.00772.
    """
    quantities = quantities_of(names)
    begins = [np.array([float(start.get(one.name, one.start)) for one in quantities]) for start in starts]
    found = [loss_of(rig, cells, names, begin) for begin in begins]
    lowest = min(found)
    best = begins[found.index(lowest)]
    strategy = CMA(best.copy(), width, seed=seed)
    for _ in range(max(0, (budget - 1) // strategy.population_size)):
        points = [strategy.ask() for _ in range(strategy.population_size)]
        losses = [loss_of(rig, cells, names, point) for point in points]
        strategy.tell(list(zip(points, losses, strict=True)))
        place = int(np.argmin(losses))
        if losses[place] < lowest:
            best, lowest = points[place], losses[place]
        if strategy.should_stop():
            break
    values = {one.name: float(value) for one, value in zip(quantities, best, strict=True)}
    return Fit(tuple(names), values, lowest)
