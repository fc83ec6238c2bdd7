"""How the cells answer to every candidate, and what that says of a table before anything is fitted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.tabulated.cells import Cells, robust, weights
from hjcamp.tabulated.fit import Fit
from hjcamp.tabulated.quantities import Quantity, candidate_quantities, quantities_of, settings_of, surprise
from hjcamp.tabulated.rig import Rig

Array = NDArray[np.float64]
#: Half the step of a response: breakaways make smaller ones rough.
SHIFT = 0.15
#: Where a logarithmic quantity is looked at besides its usual value.
FACTORS_LOOKED_AT = (0.4, 2.5)
#: The linear prediction moves the model's own quantities by at most this; a step of the fit may be longer.
FARTHEST = 0.6


@dataclass(frozen=True)
class Probe:
    """A candidate at one place of its quantities: the change of the cells' errors (cells,), and what its place costs."""

    name: str
    places: Mapping[str, float]
    change: Array
    cost: float


@dataclass(frozen=True)
class Looked:
    """The responses about a model: simulated means, slopes (cells, quantities) of its own quantities, probes of the others."""

    model: Fit
    simulated: Array
    slopes: Array
    probes: Sequence[Probe]

    def promising(self, cells: Cells, count: int) -> list[Probe]:
        """Return the best place of each of the ``count`` candidates that promise most for ``cells``, best first."""
        best: dict[str, tuple[float, Probe]] = {}
        errors = cells.errors(self.simulated)
        for probe in self.probes:
            loss, moved = self._predicted(errors + probe.change)
            if probe.name not in best or loss + probe.cost < best[probe.name][0]:
                best[probe.name] = (
                    loss + probe.cost,
                    Probe(probe.name, {**moved, **probe.places}, probe.change, probe.cost),
                )
        return [probe for _, probe in sorted(best.values(), key=lambda one: one[0])[:count]]

    def refitted(self, cells: Cells) -> dict[str, float]:
        """Return the places of the model's own quantities after a linear refit to ``cells``."""
        return self._predicted(cells.errors(self.simulated))[1]

    def _predicted(self, errors: Array) -> tuple[float, dict[str, float]]:
        """Return the loss after a linear refit of the model's own quantities, and their places."""
        quantities = quantities_of(self.model.names)
        now = np.array([self.model.places[one.name] for one in quantities])
        root = np.sqrt(weights(errors))
        known = np.array([1.0 / one.spread for one in quantities])
        away = np.array([one.surprise(place) for one, place in zip(quantities, now, strict=True)])
        left = np.vstack([self.slopes * root[:, None], np.diag(np.maximum(known, 0.3))])
        right = np.concatenate([-errors * root, -away])
        move = np.clip(np.linalg.lstsq(left, right, rcond=None)[0], -FARTHEST, FARTHEST)
        loss = float(robust(errors + self.slopes @ move).sum()) + surprise(quantities, now + move)
        return loss, {one.name: float(place) for one, place in zip(quantities, now + move, strict=True)}


def look(rig: Rig, cells: Cells, model: Fit, names: Sequence[str], done: Callable[[float], None]) -> Looked:
    """Return how the cells answer about ``model`` to its own quantities and to the candidates ``names``."""
    quantities = quantities_of(model.names)
    at = np.array([model.places[one.name] for one in quantities])

    def errors(more: Sequence[Quantity], places: Array) -> Array:
        return cells.errors(cells.of(rig.indicators(settings_of([*quantities, *more], places))))

    simulated = cells.of(rig.indicators(model.settings))
    here = cells.errors(simulated)
    slopes = []
    for index in range(len(quantities)):
        step = np.zeros(len(at))
        step[index] = SHIFT
        slopes.append((errors([], at + step) - errors([], at - step)) / (2 * SHIFT))
    probes = []
    for number, name in enumerate(names):
        done(number / len(names))
        more = candidate_quantities(name)
        for places in _looked_at(more):
            change = errors(more, np.concatenate([at, places])) - here
            named = {one.name: float(place) for one, place in zip(more, places, strict=True)}
            probes.append(Probe(name, named, change, surprise(more, places) + 2.0 * len(more)))
    return Looked(model, simulated, np.array(slopes).T, probes)


def _looked_at(quantities: Sequence[Quantity]) -> list[Array]:
    """Return the places at which a candidate is looked at: its first quantity weak, usual and strong, the others usual."""
    first, usual = quantities[0], np.array([one.start for one in quantities])
    low, high = first.parameter.bounds
    default = first.parameter.default
    values = [default * factor for factor in FACTORS_LOOKED_AT]
    if np.isfinite(first.spread):
        values = [default * np.exp(shift) for shift in (-0.4, -0.2, 0.2, 0.4)]
    elif first.parameter.off is not None or first.parameter.prior == "log-uniform":
        values.append(default)
    else:
        span = max(abs(default), 0.25 * (high - low))
        values = [default - 0.5 * span, default, default + 0.5 * span]
    if low < 0.0 < high and not np.isfinite(first.spread):
        values += [-value for value in values]
    found = []
    for value in dict.fromkeys(float(np.clip(value, low, high)) for value in values):
        places = usual.copy()
        places[0] = first.forth(value)
        found.append(places)
    return found
