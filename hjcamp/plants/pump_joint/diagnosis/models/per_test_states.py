"""What a test begins with and no rig repeats: a value of its own for each test, beside the one that all share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter

Array = NDArray[np.float64]
ROUNDS = 4
# A share of the range over which a residual is linear enough.
STEP = 0.1
# What no pressure sensor tells (Pa).
SILENT = 70.0


@dataclass(frozen=True)
class OwnStarts:
    """The starts that the effects of a model leave to each test; ``line_errors`` gives the residuals (n, 2) of the line view."""

    effects: Sequence[type[Effect]]
    edges: NDArray[np.int64]
    line_errors: Callable[[Candidate], Array]

    def corrections(self, candidate: Candidate, left: Array) -> Array | float:
        """Return what to add to the residuals ``left`` (n, 2) for the tests' own starts; 0 where a model leaves none."""
        total: Array | float = 0.0
        for effect, parameter in self._parameters(candidate):
            response, moves = self._moves(candidate, effect, parameter, left + total)
            total = total + response * np.repeat(moves, np.diff(self.edges))[:, None]
        return total

    def centred(self, candidate: Candidate) -> Candidate:
        """Return the candidate with the mean of the tests for each of these parameters."""
        for effect, parameter in self._parameters(candidate):
            _, moves = self._moves(candidate, effect, parameter, self.line_errors(candidate))
            given = {parameter.name: parameter.default, **candidate.effects[effect]}
            given[parameter.name] += float(moves.mean())
            candidate = candidate.with_effect(effect, given)
        return candidate

    def _parameters(self, candidate: Candidate) -> Iterator[tuple[str, Parameter]]:
        for effect in self.effects:
            if effect.name in candidate.effects:
                yield from ((effect.name, one) for one in effect.parameters.values() if one.each_test)

    def _moves(self, candidate: Candidate, effect: str, parameter: Parameter, left: Array) -> tuple[Array, Array]:
        """Return the response (n, 2) of the line view to a parameter, and the move (tests,) of each test."""
        given = {parameter.name: parameter.default, **candidate.effects[effect]}
        value = given[parameter.name]
        step = step_within(value, parameter.bounds)
        shared = self.line_errors(candidate)
        moved = self.line_errors(candidate.with_effect(effect, {**given, parameter.name: value + step}))
        response = (moved - shared) / step
        room = (parameter.bounds[0] - value, parameter.bounds[1] - value)
        return response, own_moves(left, response, self.edges, SILENT, room)


def step_within(value: float, bounds: tuple[float, float]) -> float:
    """Return a tenth of the range, upwards where there is room for it."""
    low, high = bounds
    step = STEP * (high - low)
    return step if value + step <= high else -step


def own_moves(residual: Array, response: Array, edges: NDArray[np.int64], least: float, room: tuple[float, float]) -> Array:
    r"""Return by how much the value of each test (tests,) differs from the common one.

    .. math:: x_t = \arg\min_x \sum_c \log\bigl(\langle (r_{tc} + x\,d_{tc})^2 \rangle + l^2\bigr)

    for the residual r and its response d to the common value (n, channels), within ``room`` (lowest and highest move);
    ``least`` is what an error must exceed to count. Solved by weighing the channels anew in each round.
    """
    counts = np.diff(edges)[:, None]
    square, cross, own = (
        np.add.reduceat(product, edges[:-1], axis=0) / counts for product in (residual**2, residual * response, response**2)
    )
    moves = np.zeros(len(counts))
    for _ in range(ROUNDS):
        left = square + 2.0 * moves[:, None] * cross + moves[:, None] ** 2 * own
        weights = 1.0 / (left + least**2)
        down, across = (weights * cross).sum(axis=1), (weights * own).sum(axis=1)
        moves = np.clip(np.where(across > 0.0, -down / np.maximum(across, 1e-300), 0.0), *room)
    return np.asarray(moves)
