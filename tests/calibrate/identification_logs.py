"""Small logs for the tests of the calibration, computed without the simulator."""

from __future__ import annotations

import math

import numpy as np

from hjcamp.records.log import TestLog

PUMP_AREA = math.pi / 4 * 6.35e-3**2
JOINT_AREA = math.pi / 4 * 4.0e-3**2
RADIUS = 3.41e-3
COUNT = 360.0 / 1024
NAMED = {"pump": "pump2", "amplifier": "high_gain", "tubing": "ldpe_300mm"}


def counted(values: np.ndarray, count: float) -> np.ndarray:
    """Return what a counting encoder reads."""
    return np.floor(values / count + 0.37) * count


def make(columns: dict[str, np.ndarray], **metadata: str) -> TestLog:
    """Return a log of the command phase alone, as foreign ones are."""
    return TestLog(columns, {**NAMED, **metadata})


def step_log(
    numerator: float = 6125.0, a2: float = 245.0, a1: float = 35700.0, a0: float = 2205000.0, delay: int = 2,
    size: float = 360.0, seed: int = 0, samples: int = 400,
) -> TestLog:  # fmt: skip
    """Return the step response of a pump with a whole number of samples of delay, through its encoder."""
    from scipy.signal import lti, step

    time = np.arange(samples) * 1e-3
    curve = step(lti([numerator], [1.0, a2, a1, a0]), T=time)[1] * size
    pump = np.concatenate([np.zeros(delay), curve[: samples - delay]]) * 360.0
    phase = np.random.default_rng(seed).uniform()
    pump = np.floor(pump / 0.18 + phase) * 0.18
    still = np.zeros(samples)
    columns = {"time_s": time, "arm_deg": still, "pressure1_mpa": still + 0.3, "pressure2_mpa": still + 0.3}
    return make({**columns, "pump_deg": pump, "command_deg": np.full(samples, size)}, repetition=str(seed))


def compliance_log(stiffness: float = 0.0257, seed: int = 0, floor_mpa: float = -1.0) -> TestLog:
    """Return a triangle of the pump with a blocked joint; no line falls below ``floor_mpa``."""
    generator = np.random.default_rng(seed)
    time = np.arange(2000) * 1e-3
    pump = 80.0 * (2.0 / np.pi) * np.arcsin(np.sin(np.pi * time))
    volume = PUMP_AREA * 1e6 * pump / 360.0
    lines = [np.maximum(0.3 + sign * stiffness * volume, floor_mpa) for sign in (1.0, -1.0)]
    noisy = [line + generator.normal(0.0, 7e-4, len(time)) for line in lines]
    columns = {"time_s": time, "arm_deg": np.zeros(2000), "pressure1_mpa": noisy[0], "pressure2_mpa": noisy[1]}
    return make({**columns, "pump_deg": counted(pump, 0.18)}, repetition=str(seed))


def leakage_log(start: float = 0.64, threshold: float = 0.59, seed: int = 0) -> TestLog:
    """Return 15 s of both lines held: 0.5 %/s, and 1/s of what is above the threshold."""
    from hjcamp.plants.pump_joint.calibrate.leakage import Leak

    generator = np.random.default_rng(seed)
    time = np.arange(15000) * 1e-3
    course = Leak(start, 0.005, 1.0, threshold).course(time)
    lines = [course + generator.normal(0.0, 7e-4, len(time)) for _ in range(2)]
    still = np.zeros(len(time))
    columns = {"time_s": time, "arm_deg": still, "pressure1_mpa": lines[0], "pressure2_mpa": lines[1]}
    return make({**columns, "pump_deg": still}, repetition=str(seed))


def friction_log(speed: float, static: float = 7.2, coulomb: float = 5.27, viscous: float = 23.5, seed: int = 0) -> TestLog:
    """Return one stroke upwards and one downwards at a slider ``speed`` (m/s), equal friction both ways."""
    generator = np.random.default_rng([seed, round(speed * 1e6)])
    scatter = math.exp(generator.normal(0.0, 0.01))
    pump_speed = speed * JOINT_AREA / PUMP_AREA
    seconds = 0.6 + 0.006 / speed
    half = round(seconds / 1e-3)
    # mm of pump travel, and N in one second of it while the arm is held: 2 dp/dV A1 A2 v.
    rise = 2 * 2.57e13 * PUMP_AREA * JOINT_AREA * pump_speed
    force, travel, level, place = [], [], 0.0, 0.0
    for sign in (1.0, -1.0):
        held = True
        for _ in range(half):
            if held:
                level += sign * rise * 1e-3
                held = sign * level < static * scatter
            else:
                level = sign * (coulomb * scatter + viscous * speed)
                place += sign * speed * 1e-3
            force.append(level)
            travel.append(place)
    time = np.arange(2 * half) * 1e-3
    pump = np.concatenate([np.arange(half), half - np.arange(half)]) * 1e-3 * pump_speed * 1e3 * 360.0
    difference = np.array(force) / JOINT_AREA * 1e-6
    lines = [0.35 + sign * 0.5 * difference + generator.normal(0.0, 7e-4, len(time)) for sign in (1.0, -1.0)]
    arm = counted(np.degrees(np.array(travel) / RADIUS), COUNT)
    columns = {"time_s": time, "arm_deg": arm, "pressure1_mpa": lines[0], "pressure2_mpa": lines[1]}
    return make({**columns, "command_deg": pump}, condition=f"{speed * 1e3:g}_mm_per_s", repetition=str(seed))
