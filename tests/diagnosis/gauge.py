"""Two tanks whose gauge has an end, solved by small steps of their own: they share no code with the program."""

from __future__ import annotations

import numpy as np
from plant_texts import TANKS

from hjcamp.records.log import TestLog

PERIOD, SMALL = 4.0, 20
BETWEEN, OUTFLOW, PUMP, NOISE, SPILL, CAUGHT = 0.05, 0.05, 0.033, 0.01, 0.1, 0.5
PLANT = TANKS.replace("    upper =", "    period = 4\n    upper =").replace("0.05, (1e-4", "0.04, (1e-4")


def measured_log(
    end: float = np.inf, brim: float = np.inf, seed: int = 1, samples: int = 1600, bend: float = 0.0, power: float = 0.5
) -> TestLog:
    """Return a log of the lower level and the pump's voltage; the gauge ends at ``end``, the upper tank has a ``brim`` (V).

    About 3 V the gauge reads more and more wrong by ``bend`` (V), below by -``bend``. The lower tank runs out with a ``power`` of its
    level, as fast as ever at 4 V.
    """
    generator = np.random.default_rng(seed)
    volts = np.repeat(generator.uniform(0.6, 5.0, samples // 40 + 1), 40)[:samples]
    upper = lower = 4.0
    levels, h = np.empty(samples), PERIOD / SMALL
    for k in range(samples):
        levels[k] = lower
        for _ in range(SMALL):
            through, over = BETWEEN * np.sqrt(upper), SPILL * max(upper - brim, 0.0)
            below = through + CAUGHT * over - OUTFLOW * 4.0 ** (0.5 - power) * lower**power
            upper = max(upper + h * (PUMP * volts[k] - through - over), 0.0)
            lower = max(lower + h * below, 0.0)
    levels = levels + bend * np.tanh((levels - 3.0) / 0.3)
    shown = np.round(np.minimum(levels + NOISE * generator.standard_normal(samples), end), 4)
    columns = {"time_s": np.arange(samples) * PERIOD, "level_v": shown, "pump_v": volts}
    return TestLog(columns, {"plant": "tanks", "period_s": str(PERIOD), "condition": f"train {seed}"})
