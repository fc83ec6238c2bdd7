"""What sensors read of inputs at once: the voltage of a cell leaps with its current."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.cached import cached
from hjcamp.model.language.vocabulary import read_vocabulary


@cached
def passed_to(plant: type[Plant], channel: str) -> tuple[int, ...]:
    """Return the places, among the given inputs, of those that a channel's sensor reads at once, by the plant's equations."""
    places = plant.sampled_inputs()
    return tuple(places.index(name) for name in plant.given_inputs() if passed_on(plant, channel, name, {}) != 0.0)


@cached
def may_be_late(plant: type[Plant]) -> tuple[str, ...]:
    """Return the inputs that may act later or earlier than logged: those in the plant's own equations, but for what a sensor reads
    at once of an input that runs on.
    """
    text = " ".join(line.expression for line in read_vocabulary(plant).statements)
    rates = plant.rates_of_inputs()
    act = {name for name in (*plant.given_inputs(), *rates) if re.search(rf"\bu_{name}\b", text)}
    act |= {source for name, source in rates.items() if name in act}
    places = {place for channel in plant.measured for place in passed_to(plant, channel)}
    seen = {plant.sampled_inputs()[place] for place in places}
    late = (name for name, item in plant.given_inputs().items() if item.hold == "previous" or name not in seen)
    return tuple(name for name in late if name in act)


@cached
def _plain(plant: type[Plant]) -> PlainModel:
    return PlainModel(plant)


def passed_on(plant: type[Plant], channel: str, name: str, base: Mapping[str, float]) -> float:
    """Return what a channel's sensor reads at once for one unit of an input, SI, at usual states; 0 where that is no number."""
    model, sensor, item = PlainModel(plant, values=dict(base)), plant.measured[channel].sensor, plant.inputs[name]
    # made once: the text is the same whatever the values
    vars(model).update(composition=_plain(plant).composition, functions=_plain(plant).functions)
    usual = {one: state.typical for one, state in plant.states.items()}
    with np.errstate(all="ignore"):
        try:
            still, moved = (model.signals({**usual, name: x})[sensor] for x in (item.default, item.default + item.typical))
        except (ArithmeticError, ValueError):
            return 0.0
    found = (moved - still) / item.typical
    return float(found) if np.isfinite(found) else 0.0
