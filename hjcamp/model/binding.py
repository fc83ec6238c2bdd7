"""Bind generic effects to the places of a plant: one ordinary effect for each place that offers all names it uses."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hjcamp.errors import HjcampError, UsageError, unknown
from hjcamp.model.amount import Amount, dimension
from hjcamp.model.amount_formula import evaluated, plain_functions
from hjcamp.model.compose import Composition, check_effect
from hjcamp.model.effect import Effect, Term
from hjcamp.model.equation_units import Units
from hjcamp.model.parameter import Parameter, State
from hjcamp.model.plant import Plant
from hjcamp.model.port import KINDS, Port
from hjcamp.model.vocabulary import read_vocabulary

EVERYWHERE = ("time",)
PERIOD = "period"
DRAWS = 64


@dataclass(frozen=True)
class Library:
    """The effects that fit a plant, by name, and for each effect that does not fit, the reason."""

    effects: Mapping[str, type[Effect]]
    unfit: Mapping[str, str]


def library_for(plant: type[Plant], effects: Mapping[str, type[Effect]]) -> Library:
    """Return which of the effects fit the plant, bound to its places, and why the others do not.

    A generic effect is called by its own name where the plant has one place for it, ``name_at_place`` where it has more.
    """
    fitting: dict[str, type[Effect]] = {}
    unfit: dict[str, str] = {}
    for name, effect in effects.items():
        try:
            found = [effect] if not effect.acts_on else bind(effect, plant)
            for one in found:
                check_effect(one, plant)
        except UsageError as problem:
            unfit[name] = str(problem)
            continue
        for one in found:
            if one.name in fitting:
                raise UsageError(
                    f"effect {name}: plant {plant.name} has an effect '{one.name}' already; choose another file name"
                )
            fitting[one.name] = one
    return Library(fitting, unfit)


def bind(effect: type[Effect], plant: type[Plant]) -> list[type[Effect]]:
    """Return the effect bound to each place of its kind, to each group of places where it is declared ``together``.

    Raises ``UsageError`` where the plant has no such place, or none that offers the names which the effect uses.
    """
    where = f"effect {effect.name or effect.__name__}"
    ports = [port for port in read_vocabulary(plant).ports.values() if port.kind == effect.acts_on]
    if not ports:
        raise UsageError(
            f"{where}: needs a {effect.acts_on} ({KINDS[effect.acts_on].text}); plant {plant.name} has none"
        )
    wanted = _wanted(effect, where)
    able = [port for port in ports if not port.lacks(wanted)]
    if not able:
        least = min(ports, key=lambda port: len(port.lacks(wanted)))
        lacks = ", ".join(sorted(least.lacks(wanted)))
        raise UsageError(
            f"{where}: needs {lacks}, which {least.kind} '{least.name}' does not offer: write "
            f"{least.kind}(..., {', '.join(f'{name}=...' for name in sorted(least.lacks(wanted)))})"
        )
    groups: dict[str, list[Port]] = {}
    for port in able:
        groups.setdefault(port.group if effect.together and port.group else port.name, []).append(port)
    return [
        _bound(effect, plant, chosen, effect.name if len(groups) == 1 else f"{effect.name}_at_{place}")
        for place, chosen in groups.items()
    ]


def _wanted(effect: type[Effect], where: str) -> set[str]:
    own = {*effect.parameters, *effect.states, *EVERYWHERE}
    terms = (*effect.terms.values(), *effect.rates.values(), *effect.updates.values(), *effect.starts.values())
    used = {name for term in terms for name in term.arguments} - own
    kind = KINDS[effect.acts_on]
    for name in effect.terms:
        if name not in kind.slots:
            raise unknown("slot", name, kind.slots, f"{where}, on a {kind.name}")
    for name in used:
        if name not in kind.names:
            raise unknown("name", name, {*kind.names, *own}, f"{where}, on a {kind.name}")
    units = [item.unit for item in effect.parameters.values()] + [item.unit for item in effect.states.values()]
    for unit in units:
        used |= _in_unit(unit, kind.names)
    return used | set(effect.terms)


def _in_unit(unit: str, names: Iterable[str]) -> set[str]:
    return set(re.findall(r"\b[A-Za-z_]\w*", unit)) & set(names)


def _bound(effect: type[Effect], plant: type[Plant], ports: Sequence[Port], name: str) -> type[Effect]:
    """Return an ordinary effect that acts on these places: states and terms for each, parameters in common."""
    several = len(ports) > 1
    groups: dict[str, dict[str, Term]] = {"terms": {}, "rates": {}, "updates": {}, "starts": {}}
    body: dict[str, Any] = {
        "__doc__": effect.__doc__,
        "__module__": effect.__module__,
        "subsystem": ports[0].subsystem or ports[0].kind,
        "same_as": effect.same_as,
        "exact_in": effect.exact_in,
        **groups,
    }
    quantities = Quantities(plant, ports[0])
    for parameter in effect.parameters.values():
        body[parameter.name] = quantities.parameter(parameter)
    for port in ports:
        owned = {state: f"{state}_{port.name}" if several else state for state in effect.states}
        names = {**port.names, **owned}
        for state, own in owned.items():
            body[own] = Quantities(plant, port).state(effect.states[state])
        groups["terms"] |= {port.names[slot]: term.on(names) for slot, term in effect.terms.items()}
        for kind in ("rates", "updates", "starts"):
            groups[kind] |= {owned[state]: term.on(names) for state, term in getattr(effect, kind).items()}
    bound: type[Effect] = type(effect.__name__, (Effect,), body)
    bound.name = name
    return bound


class Quantities:
    """The units and usual sizes of the names that a place offers."""

    def __init__(self, plant: type[Plant], port: Port) -> None:
        self.port = port
        self.units = _units(plant)
        sizes = usual_sizes(plant)
        kind = KINDS[port.kind]
        self.sizes = {local: sizes[port.names[kind.sizes.get(local, local)]] for local in port.names}

    def parameter(self, item: Parameter) -> Parameter:
        """Return a generic parameter in SI units: its default and bounds times the size of its unit."""
        unit, size = self._resolved(item.unit)
        if unit == item.unit:
            return replace(item)
        low, high = sorted(bound * size for bound in item.bounds)
        off = None if item.off is None else item.off * size
        return replace(item, unit=unit, default=item.default * size, bounds=(low, high), off=off)

    def state(self, item: State) -> State:
        """Return a generic state in SI units."""
        unit, size = self._resolved(item.unit)
        return replace(item, unit=unit, typical=item.typical * size, resolution=1e-6 * item.typical * size)

    def _resolved(self, unit: str) -> tuple[str, float]:
        """Return the SI unit and the size of a product of names of the place, of the period and of units."""
        words = set(re.findall(r"\b[A-Za-z_]\w*", unit))
        own = words & {*self.port.names, PERIOD}
        if not own:
            return unit, 1.0
        dims = {word: Amount(1.0, dimension(word)) for word in words - own}
        dims |= {word: self.units.value(self._local(word), self.port.name) for word in own - {PERIOD}}
        dims |= {PERIOD: Amount(1.0, dimension("s"))}
        whole = evaluated(unit, {**self.units.scope, **dims})
        sizes = {word: self.sizes.get(word, 1.0) for word in words} | {PERIOD: self.units.plant.period}
        return self.units.written(whole.dims), float(eval(unit, {"__builtins__": {}}, sizes))

    def _local(self, name: str) -> str:
        full = self.port.names[name]
        for prefix in ("", "s_", "p_", "u_"):
            if prefix + full in self.units.scope:
                return prefix + full
        raise HjcampError(f"place '{self.port.name}': '{full}' has no unit")


def _units(plant: Any) -> Units:
    return _units_found(plant)


@functools.cache
def _units_found(plant: Any) -> Units:
    units = Units(plant)
    units.follow(read_vocabulary(plant).statements)
    return units


def usual_sizes(plant: Any) -> Mapping[str, float]:
    """Return how large each name of a plant usually is, SI: what is declared as typical, else the rms over such states."""
    return _sizes_found(plant)


@functools.cache
def _sizes_found(plant: Any) -> Mapping[str, float]:
    vocabulary = read_vocabulary(plant)
    composition = Composition(plant)
    scope = plain_functions(composition.signals_source())
    generator = np.random.default_rng(20090403)
    out = np.zeros(len(vocabulary.signals))
    squares = []
    for _ in range(DRAWS):
        z = [state.usual(generator) for state in plant.states.values()]
        u = [plant.inputs[name].usual(generator) for name in composition.inputs]
        p = [item.default for item in plant.parameters.values()]
        scope["signals"](0.1, generator.choice((-1.0, 1.0)), z, u, p, out)
        squares.append(out**2)
    found = dict(zip(vocabulary.signals, np.sqrt(np.mean(squares, axis=0)).tolist(), strict=True))
    found |= {name: abs(item.default) for name, item in plant.parameters.items()}
    found |= {name: abs(item.typical) for name, item in plant.inputs.items()}
    found |= {name: abs(item.typical) for name, item in plant.states.items()}
    return {name: size if size > 0.0 and np.isfinite(size) else 1.0 for name, size in found.items()}
