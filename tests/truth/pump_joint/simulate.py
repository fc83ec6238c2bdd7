"""One test of the hidden rig: fixed steps of 20 us under a 1 kHz bench controller, logged once a millisecond."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from truth.compiled import fingerprint_of, within
from truth.pump_joint.arm import disc_reading
from truth.pump_joint.controller import SAMPLE, Procedure, next_phase, pid_step
from truth.pump_joint.hydraulics import PUMP_PRESSURE, fill_lines, lines_step, wall_creep
from truth.pump_joint.joint import BODY_ROWS, asperity_stiffness, joint_step
from truth.pump_joint.plant import JOINT_AREA, PULLEY_RADIUS, PUMP_AREA, Plant
from truth.pump_joint.pump import carriage_step, servo_step

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

COMPILED = ("arm", "controller", "friction", "hydraulics", "joint", "lines", "plant", "pump", "simulate")
SUBSTEPS = 50
STEP = SAMPLE / SUBSTEPS
RING = 4096
COLUMNS = (
    "time_s",
    "phase",
    "reference_deg",
    "arm_deg",
    "pressure1_mpa",
    "pressure2_mpa",
    "pump_deg",
    "command_deg",
    "pid_deg",
    "feedforward_deg",
    "dither_v",
)
ARM_COUNT = 360.0 / 1024
PUMP_COUNT = 360.0 / 2000
CONVERTER_PA = 0.689e6 / 2**14
METRES_PER_DEGREE = 1e-3 / 360


@within
def simulate(
    plant: Plant,
    procedure: Procedure,
    reference: np.ndarray,
    profile: np.ndarray,
    directions: np.ndarray,
    noise: np.ndarray,
    phases: np.ndarray,
) -> tuple[np.ndarray, int]:
    """Run one test; return the samples, shape (n, 11) in COLUMNS, and the row where the command phase begins.

    `reference` is in degrees at 1 kHz, `profile` the friction fluctuation on 0.1 mm of travel, `directions` its level
    in this test, `noise` pressure noise in Pa per sample, `phases` two fractions of a count where the encoders stand.
    Position-first symplectic Euler for the joint, implicit in damping; the lines are updated from the moved volumes.
    """
    rows = np.zeros((noise.shape[0], 11))
    hydraulic = np.zeros((7, 2))
    stiffness = np.array([plant.stiffness1, plant.stiffness2])
    stretch = np.zeros((2, 4))
    body = np.zeros(BODY_ROWS)
    body[0] = procedure.start_travel
    body[2] = procedure.start_travel
    body[4] = 1.0
    body[5] = procedure.previous_rest
    bristles = asperity_stiffness(plant)
    commands = np.zeros(RING)
    angles = np.full(RING, procedure.start_travel / PULLEY_RADIUS)
    memory = np.zeros(8)
    memory[1] = 1.0 if procedure.adjustment_difference >= 0 else -1.0
    targets = np.array([procedure.start_pressure1, procedure.start_pressure2])
    idle = np.full(2, procedure.idle_pressure)
    fill_lines(hydraulic, idle, stiffness, plant)
    lines_step(hydraulic, 0.0, 0.0, stiffness, 0.0, plant, STEP)
    nut, nut_speed, drive, carriage = 0.0, 0.0, 0.0, 0.5 * plant.backlash * procedure.start_in_play
    command, origin, relief = 0.0, 0.0, 0.0
    first, count, phase, elapsed, tick = 0, 0, 0, 0.0, 0
    arm_zero, pump_zero = 0.0, 0.0
    delay_commands = round(plant.dead_time / STEP)
    delay_angles = round(plant.encoder_delay / STEP)
    while count < rows.shape[0]:
        # --- sensors
        late_angle = disc_reading(angles[(tick - delay_angles) % RING], plant)
        if plant.encoder_form != 0.0 and delay_angles > 0:
            # an interpolator that averages twice the delay
            late_angle = 0.0
            for part in range(20):
                late_angle += disc_reading(angles[(tick - 2 * delay_angles * part // 19) % RING], plant) / 20
        arm_counts = math.floor(math.degrees(late_angle) / ARM_COUNT + phases[0])
        pump_counts = math.floor(nut / METRES_PER_DEGREE / PUMP_COUNT + phases[1])
        bent1 = 1 + plant.gain_form * math.tanh(2 * hydraulic[PUMP_PRESSURE, 0] / 0.4e6 - 2)
        bent2 = 1 + plant.gain_form * math.tanh(2 * hydraulic[PUMP_PRESSURE, 1] / 0.4e6 - 2)
        gain1, gain2 = 1 + (plant.pressure1_gain - 1) * bent1, 1 + (plant.pressure2_gain - 1) * bent2
        since = max(count - first, 0) * SAMPLE if phase >= 3 else 0.0
        faded = 1 / (1 + plant.offset_fading * since)
        reading1 = gain1 * hydraulic[PUMP_PRESSURE, 0] + faded * plant.pressure1_offset + noise[count, 0]
        reading2 = gain2 * hydraulic[PUMP_PRESSURE, 1] + faded * plant.pressure2_offset + noise[count, 1]
        difference = procedure.adjustment_difference
        adjusted = (reading1 - reading2) * math.copysign(1.0, difference) >= abs(difference)
        # --- phases of the test
        previous = phase
        phase = next_phase(phase, elapsed, adjusted, reference.shape[0] - (count - first), procedure)
        if phase == 5:
            break
        if phase != previous:
            elapsed = 0.0
            if previous == 0:
                # the unknown wait before a test: the wall creeps, then the operator tops the lines up
                wall_creep(hydraulic, stiffness, plant, procedure.waiting_time)
                fill_lines(hydraulic, targets, stiffness, plant)
                body[5] += procedure.waiting_time
                angles[:] = body[2] / PULLEY_RADIUS
            if phase == 3:
                first = count
                origin = command
                arm_zero = arm_counts
                pump_zero = pump_counts
        elapsed += SAMPLE
        angle_deg = (arm_counts - arm_zero) * ARM_COUNT + round(plant.encoder_offset / ARM_COUNT) * ARM_COUNT
        # --- controller
        wanted, pid, dither = reference[0], 0.0, 0.0
        if phase == 1:
            command += math.copysign(procedure.adjustment_speed, difference) * SAMPLE
        elif phase >= 3:
            index = min(count - first, reference.shape[0] - 1)
            wanted = reference[index]
            if phase == 3 and procedure.closed_loop > 0.0:
                change = wanted - reference[max(index - 1, 0)]
                pid = pid_step(memory, wanted - angle_deg, change, procedure)
                command = origin + pid * METRES_PER_DEGREE
            elif phase == 3:
                command = origin + procedure.scale * wanted * METRES_PER_DEGREE
            if phase == 3 and procedure.dither_volt > 0.0:
                dither = procedure.dither_volt * (1.0 if (index // 2) % 2 == 0 else -1.0)
        rows[count, 0] = count * SAMPLE
        rows[count, 1] = phase
        rows[count, 2] = wanted
        rows[count, 3] = angle_deg
        rows[count, 4] = math.floor(reading1 / CONVERTER_PA) * CONVERTER_PA * 1e-6
        rows[count, 5] = math.floor(reading2 / CONVERTER_PA) * CONVERTER_PA * 1e-6
        rows[count, 6] = pump_counts * PUMP_COUNT
        rows[count, 7] = command / METRES_PER_DEGREE
        rows[count, 8] = pid
        rows[count, 10] = dither
        # --- slow states
        wall_creep(hydraulic, stiffness, plant, SAMPLE)
        clock = (count - first) * SAMPLE if phase >= 3 else 0.0
        softening = math.exp(-plant.stiffness_decay * clock)
        stiffness[0] = plant.stiffness1 * softening
        stiffness[1] = plant.stiffness2 * softening
        relief += (plant.dither_relief * min(abs(dither) / 1.2, 1.5) - relief) * SAMPLE / 0.01
        preload = 0.0
        if phase == 0:
            preload = 1.0 / (procedure.preload_time / STEP)
        elif phase == 4:
            preload = -1.0 / (procedure.release_time / STEP)
        # --- physics
        for _ in range(SUBSTEPS):
            commands[tick % RING] = command
            delayed = commands[(tick - delay_commands) % RING]
            tick += 1
            before = nut
            nut, nut_speed, drive = servo_step(nut, nut_speed, drive, delayed, dither, plant, STEP)
            load = hydraulic[PUMP_PRESSURE, 0] - hydraulic[PUMP_PRESSURE, 1]
            moved = carriage_step(carriage, nut, nut - before, load, plant, STEP)
            pump_in = PUMP_AREA * (moved - carriage)
            carriage = moved
            if preload != 0.0:
                for line in range(2):
                    hydraulic[0, line] += preload * (targets[line] - idle[line]) / stiffness[line]
            joint_in = JOINT_AREA * body[1] * STEP
            angle = body[2] / PULLEY_RADIUS
            lines_step(hydraulic, pump_in, joint_in, stiffness, angle, plant, STEP)
            joint_step(body, stretch, bristles, hydraulic, profile, directions, relief, clock, plant, STEP)
            clock += STEP
            angles[tick % RING] = body[2] / PULLEY_RADIUS
        count += 1
    rows = rows[:count]
    for row in range(count):
        rows[row, 0] = (row - first) * SAMPLE
        rows[row, 6] -= pump_zero * PUMP_COUNT
        rows[row, 7] -= origin / METRES_PER_DEGREE
        if row < first:
            rows[row, 3] -= arm_zero * ARM_COUNT
    return rows, first


def _compiled(fingerprint: int) -> Callable[..., Any]:
    @njit(cache=True)
    def cached(plant, procedure, reference, profile, directions, noise, phases):
        rows, first = simulate(plant, procedure, reference, profile, directions, noise, phases)
        return rows, first, fingerprint

    return cached


_RUN = _compiled(fingerprint_of("contact", *(f"pump_joint/{name}" for name in COMPILED)))


def run(
    plant: Plant,
    procedure: Procedure,
    reference: np.ndarray,
    profile: np.ndarray,
    directions: np.ndarray,
    noise: np.ndarray,
    phases: np.ndarray,
) -> tuple[np.ndarray, int]:
    """Run `simulate`, compiled once for these sources and cached on disk."""
    with nullcontext() if _RUN.signatures else _alone():
        rows, first, _ = _RUN(plant, procedure, reference, profile, directions, noise, phases)
    return rows, first


@contextmanager
def _alone() -> Iterator[None]:
    """Let one process compile while others wait for what it keeps; where there are no such locks, each compiles."""
    with Path(__file__).open("rb") as own:
        if fcntl is not None:
            with suppress(OSError):
                fcntl.flock(own, fcntl.LOCK_EX)
        yield
