"""What swings by itself: an outside force, a pulsation, a rhythm, whose frequency nothing that is given has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.multistart import above_noise
from hjcamp.diagnosis.data.tests import Sensor
from hjcamp.diagnosis.levels import DELTA, LEVEL
from hjcamp.diagnosis.residuals.free_run import whole_errors
from hjcamp.diagnosis.residuals.spectral_lines import BANDWIDTH, chances, own_to, refined, sine_in

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Swing:
    """A line in what a sensor errs by over whole tests: its frequency, Hz, its rms, SI, the share of the rms that is left without
    it, and its chance.

    ``test`` is the name of the test in which it is told best, with the ``time`` (n,), s, ``errors`` and ``line`` (n,), SI, of that.
    """

    sensor: Sensor
    frequency: float
    rms: float
    left: float
    chance: float
    test: str
    time: Array
    errors: Array
    line: Array


def swing_of(analysis: Analysis, level: float) -> Swing | None:
    """Return the line that takes most of what the calibrated base errs by over whole tests; None where none matters.

    A line differs from the smooth spectrum around it at a level, over all frequencies, sensors and tests; its
    rms is more than the sensor's noise, as all that is left has to be, and takes a tenth of the rms at least. Its phase differs from
    test to test, its frequency does not. What is given has no line there, nor at a frequency of which it is a multiple.
    A plant that may ring, with more than one state, has to forget within the bandwidth of a line: 1/e in n / (8 pi) samples.
    """
    base, measured = analysis.base.fitted, analysis.measured
    found = whole_errors(analysis.windows, base.candidate) if above_noise(analysis.windows.layout, base.features) else None
    if found is None or not np.all(np.isfinite(found[1])):
        return None
    layout, errors, memory = found
    inputs = layout.joined([test.inputs for test in measured.tests])
    of_test = np.repeat(layout.of_test, layout.width)
    tests = [of_test == test for test in np.unique(of_test)]
    best: Swing | None = None
    for rows in tests:
        if len(measured.plant.states) > 1 and memory * 2.0 * np.pi * BANDWIDTH > np.count_nonzero(rows):
            continue
        for k, sensor in enumerate(measured.sensors):
            frequency, chance = chances(errors[rows, k])
            chance = np.minimum(chance * len(frequency) * len(tests) * len(measured.sensors), 1.0)
            for given in inputs[rows].T if np.any(chance <= LEVEL) else ():
                chance = np.where(own_to(frequency, given, LEVEL), chance, 1.0)
            if not len(chance) or chance.min() > level:
                continue
            at = refined(errors[rows, k], float(frequency[np.argmin(chance)]))
            lines = np.concatenate([sine_in(errors[one, k], at) for one in tests])
            own = np.concatenate([errors[one, k] for one in tests])
            squares, without = np.mean(own**2), np.mean((own - lines) ** 2)
            rms, left = float(np.sqrt(max(squares - without, 0.0))), float(np.sqrt(without / squares))
            if rms > measured.noise[k] and left <= 1.0 - DELTA and (best is None or left < best.left):
                test = measured.tests[int(of_test[np.argmax(rows)])].name
                here = (layout.time[rows], errors[rows, k], sine_in(errors[rows, k], at))
                best = Swing(sensor, at / measured.period, rms, left, float(chance.min()), test, *here)
    return best
