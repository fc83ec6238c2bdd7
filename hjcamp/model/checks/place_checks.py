"""Checks of an effect on any plant, without compiling: units, finite, absent when off, seen at its defaults."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from hjcamp.errors import UsageError, counted
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import memory_source, rates_source, signals_source, terms_source
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.amount_formula import plain_functions
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.language.quantities import usual_sizes
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
SAMPLES = 60
RESTING = 5  # samples at the start in which the contacts rest
FINITE_DRAWS = 4
SEEN = 1e-3
FLAT = 1e-6  # of its usual size: a line that moves less stays


@dataclass
class PlainModel:
    """A plant with effects as plain Python functions of its names: for one place at a time."""

    plant: type[Plant]
    effects: tuple[type[Effect], ...] = ()
    values: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def composition(self) -> Composition:
        """The plant's equations with the effects."""
        return Composition(self.plant, self.effects)

    @cached_property
    def functions(self) -> dict[str, Any]:
        """The generated functions."""
        made = self.composition
        return plain_functions(terms_source(made) + rates_source(made) + signals_source(made) + memory_source(made))

    @cached_property
    def p(self) -> Array:
        """The parameters: ``values`` by full name (``effect.parameter``), completed by the defaults."""
        return np.array([self.values.get(name, item.default) for name, item in self.composition.parameters.items()])

    def at(self, place: Mapping[str, float]) -> tuple[float, float, Array]:
        """Return time, regime of the contacts, and inputs of a place."""
        u = np.array([place.get(name, self.plant.inputs[name].default) for name in self.composition.inputs])
        return place.get("time", 0.0), self.composition.direction(place), u

    def begin(self, place: Mapping[str, float]) -> Array:
        """Return the states of a place; those of effects at their starts unless they are given."""
        z = np.array([place.get(name, 0.0) for name in self.composition.states])
        time, direction, u = self.at(place)
        self.functions["begin"](time, direction, z, u, self.p)
        for index, name in enumerate(self.composition.states):
            z[index] = place.get(name, z[index])
        return z

    def rates(self, place: Mapping[str, float], z: Array | None = None) -> dict[str, float]:
        """Return the rate of every state."""
        out = np.zeros(len(self.composition.states))
        time, direction, u = self.at(place)
        self.functions["rates"](-1, time, direction, self.begin(place) if z is None else z, u, self.p, out)
        return dict(zip(self.composition.states, out.tolist(), strict=True))

    def signals(self, place: Mapping[str, float], z: Array | None = None) -> dict[str, float]:
        """Return every slot and signal."""
        names = list(self.composition.vocabulary.signals)
        out = np.zeros(len(names))
        time, direction, u = self.at(place)
        self.functions["signals"](time, direction, self.begin(place) if z is None else z, u, self.p, out)
        return dict(zip(names, out.tolist(), strict=True))

    def along(self, course: list[dict[str, float]]) -> Array:
        """Return the signals and the rates of the plant's states (n, signals + states) along a course of these states.

        Those of effects are integrated.
        """
        states = list(self.composition.states)
        own = [index for index, name in enumerate(states) if "." in name]
        z = self.begin(course[0])
        found = []
        for now, then in zip(course, [*course[1:], course[-1]], strict=True):
            for index, name in enumerate(states):
                z[index] = now.get(name, z[index])
            found.append([*self.signals(now, z).values(), *list(self.rates(now, z).values())[: len(self.plant.states)]])
            self.functions["remember"](*self.at(now)[:2], z, self.at(now)[2], self.p)
            if own:
                z[own] = self._moved(z, own, now, then)
        return np.array(found)

    def _moved(self, z: Array, own: list[int], now: Mapping[str, float], then: Mapping[str, float]) -> Array:
        """Return the effects' own states one sample later; all else runs straight from one place to the next."""
        states = list(self.composition.states)
        names = list(self.plant.states)
        begin, end = (np.array([place[name] for name in names]) for place in (now, then))
        given, later = self.at(now)[2], self.at(then)[2]
        full, rates, p, direction = z.copy(), np.zeros(len(states)), self.p, self.at(now)[1]

        def rate(share: float, values: Array) -> Array:
            full[: len(names)], full[own] = begin + share * (end - begin), values
            time, u = now["time"] + share * self.plant.period, given + share * (later - given)
            self.functions["rates"](-1, time, direction, full, u, p, rates)
            return rates[own] * self.plant.period

        sizes = [1e-3 * abs(self.composition.states[states[index]].typical) or 1e-9 for index in own]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what fails is seen: it is not finite
            found = solve_ivp(rate, (0.0, 1.0), z[own], "LSODA", rtol=1e-4, atol=sizes)
        return np.asarray(found.y[:, -1]) if found.success else np.full(len(own), math.nan)


def course_of(plant: type[Plant]) -> list[dict[str, float]]:
    """Return a course on which every effect has its moment: a rest, then all states and inputs swing."""
    generator = np.random.default_rng(20090405)
    contacts = [port for port in read_vocabulary(plant).ports.values() if port.kind == "contact"]
    held = {port.names["velocity"] for port in contacts}
    swing: dict[str, tuple[float, float, float, float]] = {}
    for name, state in plant.states.items():
        low = state.low if math.isfinite(state.low) else -math.inf
        middle = max(low + 1.6 * state.typical, 0.0) if low > -math.inf else 0.0
        turns, phase = generator.uniform(1.0, 2.0), 0.0 if name in held else generator.uniform(0.0, 2.0 * math.pi)
        swing[name] = (middle, 1.5 * state.typical, turns, phase)
    for name, given in plant.inputs.items():
        if name not in ("time", "direction"):
            size = 0.0 if given.default else 1.5 * given.typical
            swing[name] = (given.default, size, generator.uniform(1.0, 2.0), generator.uniform(0.0, 2.0 * math.pi))
    course = []
    for sample in range(SAMPLES):
        share = max(sample - RESTING, 0) / (SAMPLES - RESTING)
        place = {
            name: middle + size * math.sin(2.0 * math.pi * turns * share + phase)
            for name, (middle, size, turns, phase) in swing.items()
        }
        place |= {name: place[name] if sample >= RESTING else 0.0 for name in held}
        place["time"] = sample * plant.period
        for port in contacts:
            place[port.names["direction"]] = float(np.sign(place[port.names["velocity"]]))
        course.append(place)
    return course


@dataclass(frozen=True)
class PlaceBench:
    """One effect on one plant, and the course along which it is tried."""

    effect: type[Effect]
    plant: type[Plant]

    def along(self, values: Mapping[str, float]) -> Array:
        """Return signals and rates along the course with the effect, its parameters by their own names."""
        named = {f"{self.effect.name}.{name}": value for name, value in values.items()}
        try:
            with np.errstate(all="ignore"):
                return PlainModel(self.plant, (self.effect,), named).along(self.course)
        except (ArithmeticError, ValueError) as problem:
            shown = ", ".join(f"{key} = {value:g}" for key, value in values.items()) or "its defaults"
            raise UsageError(f"effect {self.effect.name}: cannot be computed ({problem}) with {shown}") from None

    @cached_property
    def course(self) -> list[dict[str, float]]:
        """The course."""
        return course_of(self.plant)

    @cached_property
    def absent(self) -> Array:
        """Signals and rates without the effect."""
        return PlainModel(self.plant).along(self.course)

    def apart(self, values: Mapping[str, float], share: float = 1.0) -> tuple[float, str]:
        """Return what a share of the differences stay below that the effect makes, over the usual size or its spread, and to what."""
        sizes, signals = usual_sizes(self.plant), read_vocabulary(self.plant).signals
        # what changes a parameter need not show in any line but a rate
        shown = () if set(self.effect.terms) <= set(signals) else self.plant.states
        rates = {f"rate of {one}": self._rate_of(k) for k, one in enumerate(shown)}
        names = [*signals, *rates]
        own = {slot: self._size_of(slot) for slot in self.effect.terms} | rates
        change = np.abs(self.along(values) - self.absent)[:, : len(names)]
        largest = np.quantile(change, share, axis=0)
        usual = [own.get(name) or sizes[name] for name in names]
        # of a voltage of 4 V that moves by 10 mV, an effect is large or small beside these
        moved = self.absent[:, : len(names)].std(axis=0)
        over = [
            float(value) / (min(size, spread) if spread > FLAT * size else size)
            for value, size, spread in zip(largest, usual, moved, strict=True)
        ]
        # a switch has no size: whether a contact locks shows in its friction
        switches = {port.names.get("locks") for port in read_vocabulary(self.plant).ports.values()}
        best = max((index for index, name in enumerate(names) if name not in switches), key=over.__getitem__)
        return over[best], names[best]

    def _rate_of(self, k: int) -> float:
        """Return the rms along the course of the rate of the k-th state; 1 where it stays."""
        rates = self.absent[:, len(read_vocabulary(self.plant).signals) + k]
        return float(np.sqrt(np.mean(rates**2))) or 1.0

    def _size_of(self, slot: str) -> float:
        sizes = usual_sizes(self.plant)
        for port in read_vocabulary(self.plant).ports.values():
            for local, name in port.names.items():
                if name == slot:
                    return sizes[port.size_of(local)]
        return sizes[slot]


def units_fit(bench: PlaceBench) -> str:
    """Refuse an effect with a term or rate in a wrong unit."""
    check_units(bench.effect, bench.plant)
    return counted(len(bench.effect.terms) + len(bench.effect.rates) + len(bench.effect.updates), "method")


def finite_everywhere(bench: PlaceBench) -> str:
    """Refuse an effect that leaves the finite numbers somewhere within its bounds."""
    generator = np.random.default_rng(1)
    parameters = bench.effect.parameters.values()
    places = [{item.name: _drawn(item, generator) for item in parameters} for _ in range(FINITE_DRAWS)]
    places += [{item.name: item.bounds[end] for item in parameters if _bounded(item)} for end in (0, 1)]
    for values in places:
        if not np.all(np.isfinite(bench.along(values))):
            shown = ", ".join(f"{key} = {value:g}" for key, value in values.items())
            raise UsageError(f"effect {bench.effect.name}: not finite with {shown}")
    return f"{counted(len(places), 'place')} within the bounds"


def off_is_absent(bench: PlaceBench) -> str:
    """Refuse an effect whose parameters at their ``off`` values still change something."""
    off = {item.name: item for item in bench.effect.parameters.values() if item.off is not None}
    if not off:
        return "no parameter declares off"
    near = {name: min(max(item.off or 0.0, item.bounds[0]), item.bounds[1]) for name, item in off.items()}
    exact = all(near[name] == item.off for name, item in off.items())
    # in the limit alone, a reversal or a start may come a sample earlier
    apart, what = bench.apart(near, 1.0 if exact else 0.9)
    usual, _ = bench.apart({}, 1.0 if exact else 0.9)
    if apart > (1e-9 if exact else 0.2 * usual):
        shown = ", ".join(f"{key} = {value:g}" for key, value in near.items())
        raise UsageError(
            f"effect {bench.effect.name}: with {shown} '{what}' still differs by {apart:.2g} of its usual size "
            f"(at the defaults: {usual:.2g})"
        )
    return "exactly" if exact else "in the limit"


def seen(bench: PlaceBench) -> str:
    """Refuse an effect that changes nothing at its defaults."""
    apart, what = bench.apart({})
    if apart < SEEN:
        raise UsageError(
            f"effect {bench.effect.name}: at its defaults nothing differs by more than {apart:.2g} of its usual size; "
            "choose larger defaults"
        )
    return f"{apart:.2g} of the usual size of '{what}'"


PLACE_CHECKS: dict[str, Callable[[PlaceBench], str]] = {
    "units": units_fit,
    "finite within its bounds": finite_everywhere,
    "absent when off": off_is_absent,
    "seen": seen,
}


def _bounded(item: Parameter) -> bool:
    return all(math.isfinite(bound) for bound in item.bounds)


def _drawn(item: Parameter, generator: np.random.Generator) -> float:
    if not _bounded(item):
        return item.default
    low, high = item.bounds
    if item.prior == "log-uniform":
        return float(math.exp(generator.uniform(math.log(low), math.log(high))))
    return float(generator.uniform(low, high))
