"""The units and the usual sizes of a plant's names, in which generic effects give their own."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property

import numpy as np

from hjcamp.model.declare.parameter import Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port
from hjcamp.model.files.cached import cached
from hjcamp.model.language.amount import Amount, dimension
from hjcamp.model.language.amount_formula import evaluated, plain_functions
from hjcamp.model.language.equation_units import Units
from hjcamp.model.language.vocabulary import Vocabulary, read_vocabulary

PERIOD, PLACE = "period", "position"
DRAWS = 64


def in_lines(units: Units, name: str) -> str:
    """Return how the lines of the equations call a name of the plant."""
    return next((prefix + name for prefix in ("", "s_", "p_", "u_") if prefix + name in units.scope), name)


class Quantities:
    """The units and usual sizes of the names that a place offers."""

    def __init__(self, plant: type[Plant], port: Port) -> None:
        self.plant, self.port = plant, port

    @cached_property
    def units(self) -> Units:
        """The units of the plant's names."""
        return units_of(self.plant)

    @cached_property
    def sizes(self) -> dict[str, float]:
        """The usual size of each name of the place, SI."""
        sizes = usual_sizes(self.plant)
        return {local: sizes.get(self.port.size_of(local), 1.0) for local in self.port.names}

    def parameter(self, item: Parameter) -> Parameter:
        """Return a generic parameter in SI units: its default and bounds times the size of its unit."""
        unit, size = self._resolved(item.unit)
        if unit == item.unit:
            return replace(item)
        low, high = sorted(bound * size for bound in item.bounds)
        off = None if item.off is None else item.off * size
        placed = item.unit == PLACE and item.shape and item.prior == "uniform"
        return replace(item, unit=unit, default=item.default * size, bounds=(low, high), off=off, placed=placed)

    def state(self, item: State) -> State:
        """Return a generic state in SI units."""
        unit, size = self._resolved(item.unit)
        return replace(item, unit=unit, typical=item.typical * size, resolution=item.resolution * size)

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
        sizes = {word: self.sizes.get(word, 1.0) for word in words} | {PERIOD: self.plant.period}
        # an angle is told in rad where the plant says so, though that has no dimension
        known = {name: item.unit for name, item in self.plant.states.items()}
        known |= {name: item.unit for name, item in self.plant.inputs.items()}
        known |= {item.sensor: known[item.of] for item in self.plant.measured.values() if item.of in known}
        near = [self.port.names[unit], *self.port.names.values()] if unit in self.port.names else []
        declared = (known[name] for name in near if name in known and dimension(known[name]) == whole.dims)
        written = next(declared, "") or self.units.written(whole.dims)
        return written, float(eval(unit, {"__builtins__": {}}, sizes))

    def _local(self, name: str) -> str:
        return in_lines(self.units, self.port.names[name])


@cached
def units_of(plant: type[Plant]) -> Units:
    units = Units(plant)
    units.follow(read_vocabulary(plant).statements)
    return units


@cached
def usual_sizes(plant: type[Plant]) -> Mapping[str, float]:
    """Return how large each name of a plant usually is, SI: what is declared as typical, else the rms over such states.

    1 where that is nothing.
    """
    return {name: size if size > 0.0 and math.isfinite(size) else 1.0 for name, size in _sizes(plant).items()}


def is_nothing(plant: type[Plant], name: str) -> bool:
    """Return whether a name of a plant is 0 at its declared parameters, and no base parameter could make it anything else."""
    return _sizes(plant).get(name) == 0.0


@cached
def _sizes(plant: type[Plant]) -> Mapping[str, float]:
    vocabulary = read_vocabulary(plant)
    lines = [
        (f"d_{one.target}" if one.mark == "rate" else one.target, compile(one.expression, "<plant>", "eval"))
        for one in vocabulary.statements
    ]
    generator = np.random.default_rng(20090403)
    regimes = {f"u_{port.names['direction']}" for port in vocabulary.ports.values() if "direction" in port.names}
    squares: dict[str, list[float]] = {name: [] for name in vocabulary.signals}
    for _ in range(DRAWS):
        scope = plain_functions("") | {f"p_{name}": item.default or float(item.base) for name, item in plant.parameters.items()}
        scope |= {f"s_{name}": state.usual(generator) for name, state in plant.states.items()}
        scope |= {f"u_{name}": given.usual(generator) for name, given in plant.inputs.items()}
        scope |= {name: float(generator.choice((-1.0, 1.0))) for name in sorted({*regimes, "u_direction"})}
        with suppress(ArithmeticError, ValueError):  # what a plant's own check tells, line by line
            for name, expression in lines:
                scope[name] = eval(expression, scope)
                if name in squares:
                    squares[name].append(float(scope[name]) ** 2)
            for name, push in _unpushed(vocabulary, scope).items():
                squares[name][-1] = push**2
    found = {name: math.sqrt(sum(all_of) / len(all_of)) for name, all_of in squares.items() if all_of}
    found |= {name: abs(item.default) for name, item in plant.parameters.items()}
    found |= {name: abs(item.typical) for name, item in plant.inputs.items()}
    found |= {name: abs(item.typical) for name, item in plant.states.items()}
    return found


def _unpushed(vocabulary: Vocabulary, scope: Mapping[str, float]) -> dict[str, float]:
    """Return the push of each contact that is given none, by name: what moves its mass, without the friction."""
    found = {}
    for port in vocabulary.ports.values():
        if port.kind == "contact" and not vocabulary.pushed and "mass" in port.names:
            names = port.names
            mass = next(scope[prefix + names["mass"]] for prefix in ("", "p_", "s_") if prefix + names["mass"] in scope)
            found[names["push"]] = mass * scope[f"d_{names['velocity']}"] + scope[names["friction"]]
    return found
