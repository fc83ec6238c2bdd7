"""Two tanks, the upper one runs out into the lower one, filled by a pump; levels in V of their gauges, seconds apart."""

import math
from typing import NamedTuple

import numpy as np

PERIOD = 4.0
SUBSTEPS = 10
STEP = PERIOD / SUBSTEPS


class Tanks(NamedTuple):
    """Two tanks and what hides in them: levels in V, flows in V/s. A hidden quantity that is 0 is not there."""

    between: float = 0.05  # V^0.5/s
    outflow: float = 0.05
    pump: float = 0.035  # 1/s
    ratio: float = 1.0  # area of the upper tank over that of the lower one
    noise: float = 0.01
    count: float = 10 / 2**12
    # losses of the lower tank: by level, through a hole at a height; brims of both
    leak: float = 0.0
    hole: float = 0.0
    hole_height: float = 3.0
    brim_lower: float = 0.0
    brim_upper: float = 0.0
    spill: float = 0.1
    spill_power: float = 1.0
    caught: float = 0.0
    # the outlet: exponent added to 1/2 above a reference, or a pipe with h = a q + (q/k)^2
    exponent: float = 0.0
    reference: float = 5.0
    laminar: float = 0.0
    # the pump
    dead_band: float = 0.0
    dead_form: float = 0.0
    saturation: float = 0.0
    saturation_form: float = 0.0
    delay: float = 0.0
    delay_form: float = 0.0
    head_loss: float = 0.0
    # the gauge of the lower tank
    offset: float = 0.0
    fading_offset: float = 0.0
    gain_error: float = 0.0
    curvature: float = 0.0
    lag: float = 0.0
    lag_form: float = 0.0
    drift: float = 0.0
    drift_time: float = 0.0
    # what no law of the program has
    evaporation: float = 0.0
    day: float = 900.0
    stirring: float = 0.0
    clogging: float = 0.0
    clogging_time: float = 900.0
    siphon: float = 0.0
    siphon_height: float = 6.0


def pumped(volt: float, level: float, tanks: Tanks) -> float:
    """Return what the pump delivers to the upper tank (V/s): dead band, saturation, loss by the head that it works against.

    Soft forms: u^2/(u + b), and u/(1 + (u/s)^3)^(1/3).
    """
    if tanks.dead_band:
        soft = volt * volt / (volt + tanks.dead_band) if volt > 0 else 0.0
        volt = soft if tanks.dead_form else max(volt - tanks.dead_band, 0.0)
    if tanks.saturation:
        soft = volt / (1 + abs(volt / tanks.saturation) ** 3) ** (1 / 3)
        volt = soft if tanks.saturation_form else min(volt, tanks.saturation)
    return tanks.pump * max(volt, 0.0) * (1 - tanks.head_loss * level / 10)


def runs_out(level: float, time: float, tanks: Tanks) -> float:
    """Return what runs out of the lower tank through its outlet (V/s): Torricelli, k sqrt(h), or one of its relatives.

    A pipe of laminar and turbulent loss: h = a q + (q/k)^2. Clogging: k falls with time. Stirring: k sways.
    """
    if level <= 0.0:
        return 0.0
    factor = tanks.outflow * (1 - tanks.clogging * (1 - math.exp(-time / tanks.clogging_time)))
    factor *= 1 + tanks.stirring * math.sin(2 * math.pi * time / (0.13 * tanks.day))
    if tanks.laminar:
        square = 1 / factor**2
        return (math.sqrt(tanks.laminar**2 + 4 * square * level) - tanks.laminar) / (2 * square)
    flow = factor * math.sqrt(level)
    return flow * (level / tanks.reference) ** tanks.exponent if tanks.exponent else flow


def rates(upper: float, lower: float, volt: float, time: float, sucking: bool, tanks: Tanks) -> tuple[float, float]:
    """Return the rates of both levels (V/s)."""
    through = tanks.between * math.sqrt(max(upper, 0.0))
    over = tanks.spill * max(upper - tanks.brim_upper, 0.0) ** tanks.spill_power if tanks.brim_upper else 0.0
    loss = tanks.leak * max(lower, 0.0) + tanks.hole * math.sqrt(max(lower - tanks.hole_height, 0.0))
    if tanks.brim_lower:
        loss += tanks.spill * max(lower - tanks.brim_lower, 0.0) ** tanks.spill_power
    if lower > 0.0:
        # the air's temperature sways with the day
        loss += tanks.evaporation * max(1 + 0.8 * math.sin(2 * math.pi * time / tanks.day), 0.0)
    if sucking:
        loss += tanks.siphon
    upper_rate = pumped(volt, upper, tanks) - through - over
    return upper_rate, tanks.ratio * (through + tanks.caught * over) - runs_out(lower, time, tanks) - loss


def run(tanks: Tanks, pump: np.ndarray, start: tuple[float, float], noise: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Run one test; return rows (n, 4): gauge of the lower and of the upper tank as read (V), then both true levels.

    `pump` (V) is held for one period of 4 s, `noise` (n, 2) is that of the gauges in units of `tanks.noise`, `flow` (n,)
    the share by which the pump's flow varies. Midpoint rule with ten steps in a period.
    """
    rows = np.zeros((pump.size, 4))
    upper, lower = start
    once, seen = lower, lower
    slow = [float(pump[0])] * 2
    sucking = False
    volts = pump.tolist()
    for index in range(pump.size):
        time = index * PERIOD
        shown = seen * (1 + tanks.gain_error) + tanks.offset + tanks.curvature * seen * (seen / 10 - 1)
        shown += tanks.fading_offset * math.exp(-seen / 3)
        settled = tanks.drift_time * (1 - math.exp(-time / tanks.drift_time)) if tanks.drift_time else time
        shown += tanks.drift * settled
        readings = np.array([shown, upper]) + tanks.noise * noise[index]
        rows[index] = (*np.floor(readings / tanks.count + 0.5) * tanks.count, lower, upper)
        for step in range(SUBSTEPS):
            moment = time + step * STEP
            volt = volts[max(math.floor((moment - tanks.delay) / PERIOD + 1e-9), 0)] if not tanks.delay_form else volts[index]
            if tanks.delay and tanks.delay_form:
                share = STEP / (0.5 * tanks.delay + STEP)
                slow[0] += share * (volt - slow[0])
                slow[1] += share * (slow[0] - slow[1])
                volt = slow[1]
            volt *= 1 + flow[index]
            if tanks.siphon:
                sucking = lower > tanks.siphon_height or (sucking and lower > 0.4 * tanks.siphon_height)
            first = rates(upper, lower, volt, moment, sucking, tanks)
            half = (upper + 0.5 * STEP * first[0], lower + 0.5 * STEP * first[1])
            second = rates(*half, volt, moment + 0.5 * STEP, sucking, tanks)
            upper, lower = max(upper + STEP * second[0], 0.0), max(lower + STEP * second[1], 0.0)
            if not tanks.lag:
                seen = lower
            elif tanks.lag_form:
                once += STEP / (0.5 * tanks.lag + STEP) * (lower - once)
                seen += STEP / (0.5 * tanks.lag + STEP) * (once - seen)
            else:
                seen += STEP / (tanks.lag + STEP) * (lower - seen)
    return rows
