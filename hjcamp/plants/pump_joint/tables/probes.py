"""How the cells answer to every candidate, and what that says of a table before anything is fitted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.tables.cells import Cells, robust, weights
from hjcamp.plants.pump_joint.tables.fit import WIDEST, Fit, Fitting
from hjcamp.plants.pump_joint.tables.quantities import Quantity, candidate_quantities, settings_of, surprise
from hjcamp.plants.pump_joint.tables.rig import Rig
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
#: Where an amplitude is looked at besides its usual value.
FACTORS_LOOKED_AT = (0.4, 2.5)
#: The same for what is known within a spread, on a logarithmic scale, and for angles that come back to themselves, rad.
SHIFTS_LOOKED_AT, ANGLES_LOOKED_AT = (-0.4, -0.2, 0.2, 0.4), (0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi)
#: The linear prediction moves the model's own quantities by at most this, and holds them with at least so much;
#: a step of the fit may be longer.
FARTHEST, HELD = 0.6, 0.3
#: Least share of a place that a candidate is predicted and begun with.
LEAST_SHARE = 0.1
#: Repetitions with which candidates are looked at: each is compared with the model in the same tests.
REPETITIONS_LOOKED_AT = 2
#: What a further quantity costs, so that laws with many do not win by their number (Akaike 1974).
COST = 2.0


@dataclass(frozen=True)
class Probe:
    """A candidate at one place of its quantities: the change of the cells' errors (cells,), and what its place costs."""

    name: str
    quantities: Sequence[Quantity]
    places: Array
    change: Array

    @property
    def surprise(self) -> float:
        """What the place costs where it is known within a spread."""
        return surprise(self.quantities, self.places)

    def shared(self, share: float) -> dict[str, float]:
        """Return the places with ``share`` of the first quantity's way from where it does nothing."""
        first, off = self.quantities[0], self.quantities[0].parameter.off
        places = self.places.copy()
        if np.isfinite(first.spread):
            places[0] = first.start + share * (places[0] - first.start)
        elif off is not None:
            places[0] = first.forth(off + share * (first.back(float(places[0])) - off))
        return {one.name: float(place) for one, place in zip(self.quantities, places, strict=True)}


@dataclass(frozen=True)
class Promise:
    """What the linear prediction says of a model: its name, the loss with what its further quantities cost, where to begin."""

    name: str
    loss: float
    places: Mapping[str, float]


@dataclass(frozen=True)
class Prediction:
    """The model alone, and each candidate at its best place next to it, best first."""

    alone: Promise
    candidates: Sequence[Promise]

    @property
    def gain(self) -> float:
        """The largest predicted fall of the loss."""
        return max((self.alone.loss - one.loss for one in self.candidates), default=0.0)


@dataclass(frozen=True)
class Looked:
    """The responses about a model: simulated means, slopes (cells, quantities) of its own quantities, probes of the others.

    ``freed`` names the candidates that the base has already, within a tolerance.
    """

    model: Fit
    fitting: Fitting
    simulated: Array
    slopes: Array
    probes: Sequence[Probe]
    freed: Sequence[str] = ()

    @cached_property
    def surprises(self) -> Array:
        """What the place of each probe costs."""
        return np.array([one.surprise for one in self.probes])

    @cached_property
    def changes(self) -> Array:
        """The changes of all probes (cells, probes)."""
        return np.array([one.change for one in self.probes]).T.reshape(len(self.simulated), len(self.probes))

    @cached_property
    def at(self) -> Array:
        """The places of the model's quantities."""
        return self.fitting.begun(self.model.places)

    def predicted(self, cells: Cells) -> Prediction:
        """Return what a linear refit to ``cells`` promises, with the weights of the robust loss as they are now.

        A candidate has its own share of each place that it was looked at, or what the base has is freed of its tolerance.
        """
        errors, known = cells.errors(self.simulated), self.fitting.known
        scale = weights(errors)
        usual = Refit(self, scale, known)
        losses, moves = usual.to(errors[:, None])
        alone = Promise("", float(losses[0]), self.moved(moves[:, 0]))
        best: dict[str, Promise] = {}
        if self.probes:
            share = usual.shares(errors)
            losses, moves = usual.to(errors[:, None] + self.changes * share)
            losses = losses + self.surprises * share**2
            for number in np.argsort(losses, kind="stable"):
                probe = self.probes[number]
                if probe.name not in best:
                    places = {**self.moved(moves[:, number]), **probe.shared(float(share[number]))}
                    loss = float(losses[number]) + COST * len(probe.quantities)
                    best[probe.name] = Promise(probe.name, loss, places)
        for name in self.freed:
            own = [one.name for one in self.fitting.quantities].index(name)
            [one] = candidate_quantities(name)
            free = known.copy()
            free[own] = 1.0 / one.spread
            losses, moves = Refit(self, scale, free).to(errors[:, None])
            best[name] = Promise(name, float(losses[0]) + COST, self.moved(moves[:, 0]))
        return Prediction(alone, sorted(best.values(), key=lambda one: one.loss))

    def moved(self, moves: Array) -> dict[str, float]:
        """Return the places of the model's quantities after ``moves``."""
        return {one.name: float(place) for one, place in zip(self.fitting.quantities, self.at + moves, strict=True)}


class Refit:
    """Weighted linear refits of a model's own quantities, each known to ``1 / known``."""

    def __init__(self, looked: Looked, scale: Array, known: Array) -> None:
        self.looked, self.scale, self.known = looked, scale, known
        self.away = looked.at - looked.fitting.start
        self.weighed = looked.slopes.T * scale
        held = np.maximum(known, HELD)
        whole = self.weighed @ looked.slopes + np.diag(held**2)
        self.inverse: Array = np.asarray(np.linalg.inv(whole), dtype=np.float64)
        self.pulled = (held * known * self.away)[:, None]
        self.least = np.clip(looked.fitting.low - looked.at, -FARTHEST, 0.0)[:, None]
        self.most = np.clip(looked.fitting.high - looked.at, 0.0, FARTHEST)[:, None]

    def to(self, errors: Array) -> tuple[Array, Array]:
        """Return loss and moves for each column of ``errors`` (cells, cases)."""
        moves = np.clip(-self.inverse @ (self.weighed @ errors + self.pulled), self.least, self.most)
        away = self.known[:, None] * (self.away[:, None] + moves)
        return robust(errors + self.looked.slopes @ moves).sum(axis=0) + (away**2).sum(axis=0), moves

    def shares(self, errors: Array) -> Array:
        """Return the share of each probe's change that least squares asks for, the own quantities eliminated first."""
        changes, scaled = self.looked.changes, self.looked.changes * self.scale[:, None]
        across = self.weighed @ changes
        curved = (scaled * changes).sum(axis=0) + self.looked.surprises - (across * (self.inverse @ across)).sum(axis=0)
        pull = self.inverse @ (self.weighed @ errors[:, None] + self.pulled)
        steep = scaled.T @ errors - (across * pull).sum(axis=0)
        return np.clip(-steep / np.maximum(curved, 1e-9), LEAST_SHARE, 1.0)


def look(rig: Rig, cells: Cells, model: Fit, names: Sequence[str], crew: Crew, done: Callable[[float], None]) -> Looked:
    """Return the responses of the cells to each of the model's own quantities, and to each candidate at a few places."""
    fitting = Fitting(rig, cells, model.names)
    at = fitting.begun(model.places)
    few = rig.repeated(REPETITIONS_LOOKED_AT)
    own = [one.name for one in fitting.quantities]
    looked = [(name, places) for name in names if name not in own for places in looked_at(candidate_quantities(name))]
    here = cells.errors(cells.of(few.indicators(model.settings)))

    def probed(number: int) -> Probe:
        name, places = looked[number]
        done(number / len(looked))
        more = candidate_quantities(name)
        settings = settings_of([*fitting.quantities, *more], np.concatenate([at, places]))
        return Probe(name, more, places, cells.errors(cells.of(few.indicators(settings))) - here)

    probes = list(crew.together(probed, range(len(looked))))
    simulated = cells.of(rig.indicators(model.settings))
    return Looked(model, fitting, simulated, fitting.slopes(at, WIDEST), probes, [name for name in names if name in own])


def looked_at(quantities: Sequence[Quantity]) -> list[Array]:
    """Return the places at which a candidate is looked at: its first quantity weak, usual and strong, angles all round."""
    first, usual = quantities[0], np.array([one.start for one in quantities])
    low, high = first.parameter.bounds
    default = first.parameter.default
    values = [default * factor for factor in FACTORS_LOOKED_AT]
    if np.isfinite(first.spread):
        values = [default * np.exp(shift) for shift in SHIFTS_LOOKED_AT]
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
    for number, one in enumerate(quantities):
        if number and one.parameter.cyclic:
            found = [_turned(places, number, one.forth(angle)) for places in found for angle in ANGLES_LOOKED_AT]
    return found


def _turned(places: Array, number: int, place: float) -> Array:
    turned = places.copy()
    turned[number] = place
    return turned
