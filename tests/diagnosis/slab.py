"""A block that is heated and cools, with its closed form."""

from __future__ import annotations

import numpy as np

PLANT = '''"""A block that is heated."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Slab(Plant):
    """A block that cools to a room at 0."""

    warmth = State("K", typical=20.0)
    power = Input("W", typical=50.0)
    capacity = Parameter("J/K", 200.0)
    loss = Parameter("W/K", 2.0, (0.01, 100.0), "log-uniform", base=True)
    period = 1.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.warmth = (drive.power - parameter.loss * state.warmth) / parameter.capacity
        probe = sensor(state.warmth)
'''
NOISE = 0.2


def course(loss: float, begin: float, power: np.ndarray) -> np.ndarray:
    """The warmth of a block under power that holds for a second each, by the closed form."""
    factor, found = np.exp(-loss / 200.0), [begin]
    for one in power[:-1]:
        found.append(found[-1] * factor + one / loss * (1.0 - factor))
    return np.array(found)
