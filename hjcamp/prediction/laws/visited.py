"""Where the tests have been: the range of what a shape of an effect is a value of (a threshold, a brim, a period of travel)."""

from __future__ import annotations

from collections.abc import Mapping

from hjcamp.model.effect import Effect
from hjcamp.model.plant import Plant
from hjcamp.model.vocabulary import read_vocabulary

Range = tuple[float, float]


def visited_shapes(effect: type[Effect], plant: type[Plant], ranges: Mapping[str, Range]) -> dict[str, Range]:
    """Return for each shape of a bound effect that has the unit of a name of its place the range of that in the tests, SI."""
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
            if item.shape and signal in ranges:
                found[called.get(item.name, item.name)] = ranges[signal]
    return found
