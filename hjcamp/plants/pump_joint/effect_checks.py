"""The checks that every effect passes, ours and a user's: the test-suite and ``hjcamp effects test`` share them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Course, Followed
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.run.simulator import Simulator

Array = NDArray[np.float64]
WINDOW = 200
SHORT = 400
UNSEEN_SLOTS = ("pump_command", "pump_reading")


def bench_simulator(plant: type[Plant], effects: tuple[type[Effect], ...]) -> Simulator:
    """Return the simulator that the checks use: driven by the pump position, with a gate for each effect."""
    return Simulator(Composition(plant, effects, plant.cut("pump"), gated=True))


@dataclass(frozen=True)
class EffectBench:
    """One effect on a gated simulator that holds it, and the tests on which it is tried."""

    effect: type[Effect]
    simulator: Simulator
    courses: Mapping[str, Course]
    watch: Callable[[], AbstractContextManager[None]] = nullcontext

    def follow(self, p: Array, course: Course) -> Followed:
        """Drive the model along a course, in the time that ``watch`` allows."""
        with self.watch():
            return self.simulator.follow(p, course)

    @property
    def plant(self) -> type[Plant]:
        """The plant of the simulator."""
        return self.simulator.composition.plant

    @cached_property
    def resolutions(self) -> Array:
        """What the sensor of each channel resolves, SI: one count, or one standard deviation of its noise."""
        names = [channel.counts or channel.noise or "" for channel in self.plant.channels]
        return np.array([self.plant.parameters[name].default for name in names])

    @cached_property
    def absent(self) -> dict[str, Array]:
        """The readings of every test without the effect."""
        return {name: self.readings(course, 0.0) for name, course in self.courses.items()}

    def vector(self, gate: float, values: Mapping[str, float]) -> Array:
        """Return the parameter vector with the effect's ``values``, completed by its defaults."""
        name = self.effect.name
        full = self.effect.defaults() | dict(values)
        return self.simulator.vector({f"gate.{name}": gate} | {f"{name}.{key}": value for key, value in full.items()})

    def readings(self, course: Course, gate: float, values: Mapping[str, float] | None = None) -> Array:
        """Return the readings (n, channels) of one test, SI."""
        return self.follow(self.vector(gate, values or {}), course).readings

    def difference(self, name: str, values: Mapping[str, float] | None = None) -> Array:
        """Return the rms difference that the effect makes to each channel, in what its sensor resolves."""
        return self.sizes(self.readings(self.courses[name], 1.0, values) - self.absent[name])

    def sizes(self, apart: Array) -> Array:
        """Return the rms of each channel of ``apart`` (n, channels), in what its sensor resolves."""
        return np.sqrt(np.mean(apart**2, axis=0)) / self.resolutions

    def usual_size(self, apart: Array) -> float:
        """Return what 90 % of the samples stay below, in the worst channel: a slip may come a millisecond earlier."""
        return float(np.max(np.percentile(np.abs(apart), 90, axis=0) / self.resolutions))

    @cached_property
    def clearest(self) -> tuple[str, Array]:
        """The test that shows the effect best, and the difference of each channel there."""
        found = {name: self.difference(name) for name in self.courses}
        best = max(found, key=lambda name: float(np.max(found[name])))
        return best, found[best]

    @property
    def replayed(self) -> bool:
        """Whether a replay can show the effect: what acts before the pump's own encoder is measured, not simulated."""
        return not set(self.effect.terms) <= set(UNSEEN_SLOTS)


def units_fit(bench: EffectBench) -> str:
    """Refuse an effect with a term or rate in a wrong unit."""
    check_units(bench.effect, bench.plant)
    return counted(len(bench.effect.terms) + len(bench.effect.rates) + len(bench.effect.updates), "method")


def finite_everywhere(bench: EffectBench, draws: int = 8) -> str:
    """Refuse an effect that leaves the finite numbers somewhere within its bounds."""
    generator = np.random.default_rng(1)
    places: list[dict[str, float]] = [_drawn(bench.effect, generator) for _ in range(draws)]
    places += [{p.name: p.bounds[end] for p in bench.effect.parameters.values() if _bounded(p)} for end in (0, 1)]
    for values in places:
        for name, course in bench.courses.items():
            if not np.all(np.isfinite(bench.readings(_first(course, SHORT), 1.0, values))):
                shown = ", ".join(f"{key} = {value:g}" for key, value in values.items())
                raise UsageError(f"effect {bench.effect.name}: not finite in the test '{name}' with {shown}")
    return f"{counted(len(places), 'place')} within the bounds"


def off_is_absent(bench: EffectBench) -> str:
    """Refuse an effect whose parameters at their ``off`` values still change a test."""
    off = {p.name: p for p in bench.effect.parameters.values() if p.off is not None}
    if not off:
        return "no parameter declares off"
    near = {name: min(max(p.off or 0.0, p.bounds[0]), p.bounds[1]) for name, p in off.items()}
    exact = all(near[name] == p.off for name, p in off.items())
    for name, course in bench.courses.items():
        windows = _windowed(course, bench.follow(bench.vector(0.0, {}), course).ideal)
        absent = bench.readings(windows, 0.0)
        apart, usual = (bench.usual_size(bench.readings(windows, 1.0, values) - absent) for values in (near, {}))
        if apart > (1e-6 if exact else max(0.5 * usual, 1.0)):
            shown = ", ".join(f"{key} = {value:g}" for key, value in near.items())
            raise UsageError(
                f"effect {bench.effect.name}: with {shown} the test '{name}' still differs by {apart:.2g} of what the "
                f"sensors resolve (at the defaults: {usual:.2g})"
            )
    return "exactly" if exact else "in the limit"


def gate_is_absent(bench: EffectBench) -> str:
    """Refuse an effect that changes a test although its gate is closed."""
    other = {p.name: _moved(p) for p in bench.effect.parameters.values()}
    for name, course in bench.courses.items():
        if not np.array_equal(bench.readings(course, 0.0, other), bench.absent[name]):
            raise UsageError(f"effect {bench.effect.name}: changes the test '{name}' although it is switched off")
    return "bit for bit"


def visible(bench: EffectBench) -> str:
    """Refuse an effect that, at its defaults, no test of the menu shows above what the sensors resolve."""
    if not bench.replayed:
        return "acts before the pump's encoder: only closed-loop simulation shows it"
    name, apart = bench.clearest
    if np.max(apart) < 1.0:
        raise UsageError(
            f"effect {bench.effect.name}: no test of the menu shows it at its defaults; the largest difference is "
            f"{np.max(apart):.2g} of what the sensor resolves, in '{name}'. Choose a larger default"
        )
    channel = bench.plant.channels[int(np.argmax(apart))]
    return f"{np.max(apart):.3g} times the resolution of {channel.field} in '{name}'"


def amplitude_recovered(bench: EffectBench, tolerance: float = 0.05) -> str:
    """Refuse an effect whose amplitude is not found again from a simulated test that holds it."""
    if not bench.replayed:
        return "not from replays"
    parameter = amplitude(bench.effect)
    if parameter.default == 0.0:
        raise UsageError(f"effect {bench.effect.name}: {parameter.name} has the default 0; give it a visible one")
    true = _within(parameter, 1.2 * parameter.default)
    test = bench.courses[bench.clearest[0]]
    measured = bench.follow(bench.vector(1.0, {parameter.name: true}), test)
    windows = _windowed(test, measured.ideal)
    wanted = bench.follow(bench.vector(1.0, {parameter.name: true}), windows).readings

    def residual(factor: Array) -> Any:
        guess = {parameter.name: _within(parameter, float(factor[0]) * parameter.default)}
        return np.ravel((bench.readings(windows, 1.0, guess) - wanted) / bench.resolutions)

    from scipy.optimize import least_squares

    fits = [least_squares(residual, [start], diff_step=0.03, x_scale=0.3, max_nfev=30) for start in (0.85, 1.5)]
    found = min(fits, key=lambda fit: fit.cost).x[0] * parameter.default
    if not abs(found - true) <= tolerance * abs(true):
        raise UsageError(
            f"effect {bench.effect.name}: {parameter.name} = {true:.4g} {parameter.unit} was simulated, "
            f"{found:.4g} was found from it; is it a parameter that changes nothing, or in very small steps?"
        )
    return f"{parameter.name} within {100 * abs(found / true - 1):.2g} %"


CHECKS: dict[str, Callable[[EffectBench], str]] = {
    "units": units_fit,
    "finite within its bounds": finite_everywhere,
    "absent when off": off_is_absent,
    "absent when switched off": gate_is_absent,
    "visible": visible,
    "recovered from data": amplitude_recovered,
}


def amplitude(effect: type[Effect]) -> Parameter:
    """Return the parameter that sets the size of the effect: the first with an ``off`` value, else the first."""
    named = [parameter for parameter in effect.parameters.values() if parameter.off is not None]
    return (named or list(effect.parameters.values()))[0]


def _bounded(parameter: Parameter) -> bool:
    return all(math.isfinite(bound) for bound in parameter.bounds)


def _within(parameter: Parameter, value: float) -> float:
    return min(max(value, parameter.bounds[0]), parameter.bounds[1])


def _moved(parameter: Parameter) -> float:
    return _within(parameter, 1.7 * parameter.default if parameter.default else 0.1)


def _drawn(effect: type[Effect], generator: np.random.Generator) -> dict[str, float]:
    values = {}
    for parameter in effect.parameters.values():
        if _bounded(parameter):
            low, high = parameter.bounds
            logarithmic = parameter.prior == "log-uniform"
            share = generator.uniform()
            values[parameter.name] = low * (high / low) ** share if logarithmic else low + share * (high - low)
    return values


def _first(course: Course, samples: int) -> Course:
    return Course(course.period, *(getattr(course, name)[:samples] for name in _ARRAYS))


def _windowed(course: Course, ideal: Array) -> Course:
    """Return the course with the true states set again every ``WINDOW`` samples: slips then keep their instants."""
    restart = course.restart.copy()
    restart[WINDOW::WINDOW] = 1
    velocity = np.gradient(ideal[:, -1], course.period)
    velocity[np.abs(velocity) < 1e-4] = 0.0
    return replace(course, restart=restart, observed=ideal, velocity=velocity[:, None])


_ARRAYS = ("restart", "time", "driven", "observed", "velocity", "given")
