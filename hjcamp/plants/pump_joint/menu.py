"""A small menu of pump motions on which an effect is tried out: about two seconds each, driven by the pump position."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.course import Course
from hjcamp.model.declare.plant import Plant
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import PERIOD

Array = NDArray[np.float64]
SAMPLES = 2000


def pump_courses(plant: type[Plant]) -> dict[str, Course]:
    """Return the tests by name: a sine, ramps with holds at a high preload and with dither, slow small triangles."""
    time: Array = np.arange(SAMPLES, dtype=np.float64) * PERIOD
    square: Array = np.where(np.arange(SAMPLES) // 2 % 2 == 0, 1.2, -1.2)
    sine: Array = 2e-3 * np.sin(2 * np.pi * time)
    ramps = np.interp(time, [0.2, 0.5, 0.9, 1.4, 1.8], [0.0, 2.5e-3, 2.5e-3, -1.5e-3, -1.5e-3])
    slow = np.interp(time, [0.3, 0.8, 1.3, 1.8], [0.0, 5e-4, -3e-4, 2e-4])
    return {
        "sine": _course(plant, time, sine, (0.28e6, 0.24e6), 0.0 * square),
        "ramps with holds": _course(plant, time, ramps, (0.65e6, 0.60e6), square),
        "slow triangles": _course(plant, time, slow, (0.34e6, 0.18e6), 0.0 * square),
    }


def _course(plant: type[Plant], time: Array, pump: Array, pressures: tuple[float, float], dither: Array) -> Course:
    observed = np.zeros((len(time), 4))
    observed[:, 0] = pump
    observed[:, 1:3] = pressures
    restart = np.zeros(len(time), dtype=np.int64)
    restart[0] = 2
    given = inputs_along(plant, len(time), dither=dither)
    return Course(PERIOD, restart, time, pump[:, None], observed, np.zeros((len(time), 1)), given)
