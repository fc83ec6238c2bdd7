"""A carriage in somebody else's loop, solved by small steps of its own: it shares no code with the program."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
PERIOD = 2e-3
SMALL = 20
GAIN, MASS, COULOMB, VISCOUS, COUNT = 35.0, 80.0, 15.0, 260.0, 1e-6


def nothing(x: float, v: float) -> float:
    """No further force."""
    return 0.0


def measured_log(
    force: Callable[[float, float], float] = nothing,
    seconds: float = 16.0,
    seed: int = 1,
    condition: str = "swing",
    path: Callable[[Array], Array] | None = None,
    gain: Callable[[float, float], float] = lambda x, v: GAIN,
    noise: float = 0.0,
) -> TestLog:
    """Return a log of position (counted) and voltage; ``force`` (N) of position and velocity is what may be hidden.

    ``path`` gives the wanted place (m) over time (s) where it is not three sines, ``gain`` (N/V) what the motor makes of a volt;
    ``noise`` (m) is what the log has beside the place, white.
    """
    generator = np.random.default_rng(seed)
    phases = generator.uniform(0.0, 2.0 * np.pi, 3)
    time = np.arange(round(seconds / PERIOD)) * PERIOD
    wanted = sum(
        size * np.sin(2.0 * np.pi * rate * time + phase)
        for size, rate, phase in zip((0.06, 0.03, 0.015), (0.21, 0.57, 1.13), phases, strict=True)
    )
    wanted = path(time) if path else wanted - wanted[0]
    # plain numbers, not numpy's: they are four times as fast
    targets = [float(one) for one in wanted]
    x = v = 0.0
    h = PERIOD / SMALL
    places, volts = np.empty(len(time)), np.empty(len(time))
    for k, target in enumerate(targets):
        places[k] = round(x / COUNT) * COUNT
        voltage = 160.0 * (target - x) - 6.0 * v
        volts[k] = voltage
        for _ in range(SMALL):
            push = gain(x, v) * voltage + float(force(x, v)) - VISCOUS * v
            if v == 0.0 and abs(push) <= COULOMB:
                continue
            way = math.copysign(1.0, v if v != 0.0 else push)
            after = v + h * (push - way * COULOMB) / MASS
            if v != 0.0 and after * v < 0.0:
                after = 0.0
            x, v = x + 0.5 * h * (v + after), after
    places = places + noise * generator.standard_normal(len(time))
    columns = {"time_s": time, "position_m": places, "voltage_v": volts}
    return TestLog(columns, {"plant": "axis", "period_s": str(PERIOD), "condition": condition})
