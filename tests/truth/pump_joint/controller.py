"""The bench's controller at 1 kHz: open loop, or the PID of thesis 5.2 with dither, and the five phases of a test."""

from typing import NamedTuple

import numpy as np

from truth.compiled import within

DIFFERENCE_SAMPLES = 5
SAMPLE = 1e-3


class Procedure(NamedTuple):
    """What the bench does in one test; pressures in Pa, times in s, speeds in m/s, gains in degrees of arm angle."""

    closed_loop: float = 0.0
    dither_volt: float = 0.0
    start_pressure1: float = 0.4e6
    start_pressure2: float = 0.4e6
    idle_pressure: float = 0.06e6
    preload_time: float = 0.4
    adjustment_difference: float = 0.0
    adjustment_speed: float = 1e-3
    rest_time: float = 0.2
    release_time: float = 0.2
    waiting_time: float = 5.0
    previous_rest: float = 30.0
    start_travel: float = 0.0
    start_in_play: float = 0.0
    kp_positive: float = 1.05
    ki_positive: float = 70.0
    kd_positive: float = 0.015
    kp_negative: float = 1.4
    ki_negative: float = 90.0
    kd_negative: float = 0.018
    scale: float = 8.5


@within
def pid_step(memory: np.ndarray, error: float, reference_change: float, procedure: Procedure) -> float:
    """Return the PID part of the pump command (deg) and update the memory (integral, direction, five past errors).

    Thesis 5.2.1.2 and 5.2.3.1; gains by the direction of the reference, the last direction kept while it rests. The
    integral is taken over Ki e, so that a change of gains is bumpless.
    """
    if reference_change > 1e-9:
        memory[1] = 1.0
    elif reference_change < -1e-9:
        memory[1] = -1.0
    forward = memory[1] >= 0.0
    kp = procedure.kp_positive if forward else procedure.kp_negative
    ki = procedure.ki_positive if forward else procedure.ki_negative
    kd = procedure.kd_positive if forward else procedure.kd_negative
    memory[0] += ki * error * SAMPLE
    slope = (error - memory[2 + DIFFERENCE_SAMPLES - 1]) / (DIFFERENCE_SAMPLES * SAMPLE)
    for index in range(DIFFERENCE_SAMPLES - 1, 0, -1):
        memory[2 + index] = memory[1 + index]
    memory[2] = error
    return procedure.scale * (kp * error + memory[0] + kd * slope)


@within
def next_phase(phase: int, elapsed: float, adjusted: bool, samples_left: int, procedure: Procedure) -> int:
    """Return the phase of the next sample: 0 preload, 1 adjustment, 2 rest, 3 command, 4 release, 5 finished."""
    if phase == 0 and elapsed >= procedure.preload_time - 1e-9:
        return 2 if procedure.adjustment_difference == 0.0 else 1
    if phase == 1 and (adjusted or elapsed > 0.7):
        return 2
    if phase == 2 and elapsed >= procedure.rest_time - 1e-9:
        return 3
    if phase == 3 and samples_left <= 0:
        return 4
    if phase == 4 and elapsed >= procedure.release_time - 1e-9:
        return 5
    return phase
