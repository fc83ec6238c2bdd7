"""A block that is heated and cools, with its closed form."""

from __future__ import annotations

import numpy as np
from plant_texts import SLAB

PLANT = SLAB
NOISE = 0.2


def course(loss: float, begin: float, power: np.ndarray) -> np.ndarray:
    """The warmth of a block under power that holds for a second each, by the closed form."""
    factor, found = np.exp(-loss / 200.0), [begin]
    for one in power[:-1]:
        found.append(found[-1] * factor + one / loss * (1.0 - factor))
    return np.array(found)
