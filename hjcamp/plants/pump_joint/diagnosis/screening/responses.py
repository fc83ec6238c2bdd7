"""What each effect would do to the residuals: its finite responses over a grid of shapes, as columns."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import Unknown, read, written

Array = NDArray[np.float64]
GRID = {1: 4, 2: 3}
STRENGTHS = 8
WANTED = 1.5
SMOOTH = 2


@dataclass(frozen=True)
class Probe:
    """One shape of one effect: its parameters without amplitudes, and the positions of its response columns.

    ``lifted`` names, column by column, the amplitude that the column raises from "off" to its value in ``heights``;
    ``shifts`` holds, column by column, the move of the base parameters (on the fitted scale) that goes with it. Where
    the effect has an ``angle``, its columns are those at 0 and at a quarter turn (``turns``), of which others are sums.
    """

    effect: str
    parameters: dict[str, float]
    lifted: tuple[str, ...]
    columns: tuple[int, ...]
    signed: tuple[bool, ...]
    shifts: tuple[tuple[float, ...], ...] = ()
    heights: tuple[float, ...] = ()
    turns: tuple[float, ...] = ()
    angle: str = ""

    def lifts(self, coefficients: Array) -> dict[str, float]:
        """Return the amplitudes that the coefficients of the columns ask for, and the angle (rad) if there is one."""
        values = [float(factor) * height for factor, height in zip(coefficients, self.heights, strict=True)]
        if not self.angle:
            return {name: value for name, value in zip(self.lifted, values, strict=True) if name}
        whole = sum(value * complex(math.cos(turn), math.sin(turn)) for value, turn in zip(values, self.turns, strict=True))
        return {self.lifted[0]: abs(whole), self.angle: math.atan2(whole.imag, whole.real)}


def amplitudes(effect: type[Effect]) -> list[str]:
    """Return the linear amplitudes of an effect: parameters with an "off" value that are not shapes."""
    return [name for name, parameter in effect.parameters.items() if parameter.off is not None and not parameter.shape]


def angle_of(effect: type[Effect]) -> str:
    """Return the name of the angle at which the only amplitude of an effect acts, or an empty string."""
    angles = [name for name, parameter in effect.parameters.items() if parameter.shape and parameter.cyclic]
    return angles[0] if len(angles) == 1 and len(amplitudes(effect)) == 1 else ""


def strength_is_a_shape(effect: type[Effect]) -> bool:
    """Whether an effect has no amplitude and one shape, which is its strength then."""
    return not amplitudes(effect) and sum(parameter.shape for parameter in effect.parameters.values()) == 1


def grid(parameter: Parameter, points: int) -> list[float]:
    """Return values of a shape parameter over its bounds: geometric for a log-uniform prior, else even."""
    low, high = parameter.bounds
    if parameter.prior == "log-uniform":
        return [float(value) for value in np.geomspace(low, high, points + 2)[1:-1]]
    if not math.isfinite(high - low):
        return [parameter.default]
    if parameter.cyclic:
        return [float(value) for value in np.linspace(-math.pi, math.pi, points + 1)[:-1]]
    return [float(value) for value in np.linspace(low, high, points + 2)[1:-1]]


def shapes(effect: type[Effect]) -> Iterator[dict[str, float]]:
    """Yield the combinations of the shape parameters to be tried, the default among them, without an angle."""
    names = [name for name, parameter in effect.parameters.items() if parameter.shape and name != angle_of(effect)]
    if not names:
        yield {}
        return
    points = STRENGTHS if strength_is_a_shape(effect) else GRID.get(len(names), 3)
    axes = [grid(effect.parameters[name], points) for name in names]
    default = tuple(effect.parameters[name].default for name in names)
    for values in dict.fromkeys([default, *itertools.product(*axes)]):
        yield dict(zip(names, values, strict=True))


def work_of(effect: type[Effect]) -> int:
    """Return about how long it takes to probe an effect, in no unit: its shapes, with its own states."""
    return sum(1 for _ in shapes(effect)) * (1 + len(effect.states))


class Responses:
    """Collects response columns (columns, blocks, channels) about one fitted model."""

    def __init__(self, fitter: Fitter, about: Fit, noise_floor: Array, unknowns: Sequence[Unknown], jacobian: Array) -> None:
        self.fitter, self.about, self.noise_floor, self.unknowns = fitter, about, noise_floor, unknowns
        weights = np.sqrt(fitter.weights(about.mean_square))
        weights[:, :SMOOTH] = 0.0
        self.weights = weights
        flat = (jacobian * weights).reshape(len(jacobian), -1)
        spread = np.array([unknown.spread for unknown in unknowns]) ** -2.0
        gram = flat @ flat.T
        self.solve = np.linalg.solve(gram + np.diag(spread) + 1e-6 * np.trace(gram) * np.eye(len(gram)), flat)
        self.spoken = np.maximum(fitter.features.valid.sum(axis=0), 1)

    def response(self, effect: type[Effect], parameters: dict[str, float], windows: bool = True) -> Array:
        """Return the change of the features that the effect makes, without ``windows`` in those of lines and forces only."""
        full = {**effect.defaults(), **parameters}
        fitter = self.fitter if windows else replace(self.fitter, windows=False)
        change = fitter.look(self.about.candidate.with_effect(effect.name, full)).features - self.about.features
        change[:, : 0 if windows else SMOOTH] = 0.0
        return np.nan_to_num(change)

    def compensated(self, effect: type[Effect], parameters: dict[str, float], response: Array) -> tuple[Array, Array]:
        """Return the response together with the move of the base that makes up for it best, and that move.

        The move is found where the residuals are smooth (lines, forces): windows with slips answer too wildly.
        """
        move = np.clip(-self.solve @ (self.weights * response).ravel(), -0.7, 0.7)
        candidate = self.about.candidate.with_effect(effect.name, {**effect.defaults(), **parameters})
        places = read(candidate, self.unknowns) + move
        seen = self.fitter.look(written(candidate, self.unknowns, places))
        return np.nan_to_num(seen.features - self.about.features), move

    def size(self, response: Array) -> float:
        """Return the size of a response over the floor, in the channel where it is largest; silent channels count nothing."""
        size = np.sqrt((response**2).sum(axis=0) / self.spoken)
        return float(np.max(np.divide(size, self.noise_floor, out=np.zeros_like(size), where=self.noise_floor > 0.0)))

    def probe(self, effect: type[Effect]) -> tuple[list[Probe], Array]:
        """Evaluate every shape of an effect: its probes and their response columns; invisible shapes are left out."""
        found: list[Probe] = []
        every: list[Array] = []
        linear, angle = amplitudes(effect), angle_of(effect)
        quarters = (0.0, 0.5 * math.pi) if angle else (0.0,)
        off = {name: float(effect.parameters[name].off or 0.0) for name in linear}
        scale: dict[str, float] = {}
        for shape in shapes(effect):
            columns, lifted, signed, shifts, heights, turns = [], [], [], [], [], []
            for name, turn in itertools.product(linear or [""], quarters):
                given = {**off, **shape, **({angle: turn} if angle else {})}
                parameter = effect.parameters.get(name)
                if parameter is not None:
                    # what is absent by default is tried at a tenth of its bound
                    given[name] = scale.get(name) or parameter.default or 0.1 * parameter.bounds[1]
                # An effect without amplitude needs no scale: where the base moves is told without the windows.
                response = self.response(effect, given, windows=parameter is not None)
                size = self.size(response) if parameter is not None else WANTED
                if parameter is not None and size > 0 and not 0.4 < size < 4.0:
                    low, high = parameter.bounds
                    given[name] = min(max(given[name] * min(max(WANTED / size, 1e-4), 1e4), low), high)
                    response = self.response(effect, given)
                    size = self.size(response)
                if parameter is not None:
                    scale[name] = given[name]
                if not 0.02 < size < 1e6:
                    continue
                response, move = self.compensated(effect, given, response)
                if parameter is None and not 0.02 < self.size(response) < 1e6:
                    continue
                shifts.append(tuple(float(step) for step in move))
                columns.append(len(every))
                lifted.append(name)
                heights.append(given.get(name, 0.0))
                turns.append(turn)
                signed.append(parameter is not None and (parameter.bounds[0] < 0 or bool(angle)))
                every.append(response)
            if columns:
                places = tuple(lifted), tuple(columns), tuple(signed), tuple(shifts), tuple(heights), tuple(turns)
                found.append(Probe(effect.name, shape, *places, angle))
        return found, np.array(every) if every else np.zeros((0, *self.about.features.shape))


def probe_all(
    fitter: Fitter,
    about: Fit,
    noise_floor: Array,
    effects: Sequence[type[Effect]],
    unknowns: Sequence[Unknown],
    jacobian: Array,
) -> tuple[list[Probe], Array]:
    """Return the probes of all effects about a fit, and their response columns (columns, blocks, channels).

    ``jacobian`` (unknowns, blocks, channels) are the responses of the unknowns already in the model.
    """
    responses = Responses(fitter, about, noise_floor, unknowns, jacobian)
    probes: list[Probe] = []
    columns = [np.zeros((0, *about.features.shape))]
    longest_first = sorted(effects, key=work_of, reverse=True)
    answers = dict(zip(longest_first, fitter.crew.each(Responses.probe, responses, longest_first), strict=True))
    for found, own in (answers[effect] for effect in effects):
        begin = sum(len(part) for part in columns)
        probes += [replace(probe, columns=tuple(begin + column for column in probe.columns)) for probe in found]
        columns.append(own)
    return probes, np.concatenate(columns)
