"""Where the tests have been: the range of what a parameter of an effect is a value of (a threshold, a brim, a period of travel)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.vocabulary import read_vocabulary

Range = tuple[float, float]


def visited_shapes(effect: type[Effect], plant: type[Plant], ranges: Mapping[str, Range]) -> dict[str, Range]:
    """Return for each shape of a bound effect that has the unit of a name of its place the range of that in the tests, SI."""
    return {name: range_ for name, (item, range_) in _visited(effect, plant, ranges).items() if item.shape}


def about_visited(effect: type[Effect], plant: type[Plant], ranges: Mapping[str, Range]) -> type[Effect]:
    """Return a bound effect whose places (parameters that are ``placed``) lie about the middle of what the tests visit, SI.

    The zero of their scale, to which bounds are declared, means nothing.
    """
    moved = dict(effect.parameters)
    for name, (_, (low, high)) in _visited(effect, plant, ranges).items():
        item, middle = moved[name], 0.5 * (low + high)
        if item.placed:
            bounds = (item.bounds[0] + middle, item.bounds[1] + middle)
            moved[name] = replace(item, default=item.default + middle, bounds=bounds)
    if moved == effect.parameters:
        return effect
    groups = {"terms": effect.terms, "rates": effect.rates, "updates": effect.updates, "starts": effect.starts}
    made: Any = type(effect)
    found: type[Effect] = made(
        effect.__name__, (effect,), {"__doc__": effect.__doc__, "__module__": effect.__module__, **groups}
    )
    found.parameters = moved
    return found


def largest_commands(effect: type[Effect], plant: type[Plant], ranges: Mapping[str, Range]) -> dict[str, float]:
    """Return for each amplitude of an actuator's effect that has the unit of its command the largest command in the tests, SI.

    Where an actuator keeps more than that to itself it does nothing, and nothing is told of it.
    """
    generic = getattr(effect, "made_of", (None,))[0]
    if generic is None or generic.acts_on != "actuator":
        return {}
    return {name: max(map(abs, range_)) for name, (item, range_) in _visited(effect, plant, ranges).items() if not item.shape}


def _visited(effect: type[Effect], plant: type[Plant], ranges: Mapping[str, Range]) -> dict[str, tuple[Parameter, Range]]:
    """Return the generic parameter, and the range of that in the tests, of each that has the unit of a name of its place."""
    generic, _, _, _, instance = getattr(effect, "made_of", (None,) * 5)
    if generic is None:
        return {}
    found = {}
    for port in read_vocabulary(plant).ports.values():
        # what an effect adds to one store it may take from another: its place is where all of it acts
        if port.kind != generic.acts_on or not {port.names.get(slot) for slot in generic.terms} >= set(effect.terms):
            continue
        called = instance.at.get(port.name, {}) if instance else {}
        for item in generic.parameters.values():
            signal = port.names.get(item.unit, "")
            if signal in ranges:
                found[called.get(item.name, item.name)] = (item, ranges[signal])
    return found
