"""A plant's inputs over a test, in its order."""

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
