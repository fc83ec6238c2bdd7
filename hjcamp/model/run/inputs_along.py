"""A plant's inputs over a test, in its order, and the rates of those that have one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import unknown
from hjcamp.model.declare.plant import Plant

Array = NDArray[np.float64]


def inputs_along(plant: type[Plant], samples: int, **columns: Array | float) -> Array:
    """Return a plant's inputs (samples, inputs) in its order: the named ones as given, all others at their defaults.

    Raises ``UsageError`` for a name that is no input of the plant.
    """
    names = plant.sampled_inputs()
    for name in columns:
        if name not in names:
            raise unknown("input", name, names, f"plant {plant.name}")
    return np.column_stack(
        [np.broadcast_to(columns.get(name, plant.inputs[name].default), samples) for name in names] or [np.empty((samples, 0))]
    ).astype(float)


def with_rates(plant: type[Plant], inputs: Array, period: float) -> Array:
    """Return a plant's inputs (samples, inputs) with those that are the rate of another one as that one goes on, ``period`` s a sample.

    What runs linearly from each sample to the next has this rate between them; behind the last one it stands.
    """
    if not plant.rates_of_inputs():
        return inputs
    names, found = plant.sampled_inputs(), inputs.copy()
    for name, source in plant.rates_of_inputs().items():
        course = inputs[:, names.index(source)]
        found[:, names.index(name)] = np.diff(course, append=course[-1:]) / period
    return found
