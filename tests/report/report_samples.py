"""Synthetic logs for the tests of the report: small, exact, without noise unless asked for."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import yaml

from hjcamp.configuration.composer import Composer
from hjcamp.records.log import TestLog
from hjcamp.trajectories import build_trajectory

SHAPES: dict[str, dict[str, Any]] = {
    "ramp_pos": {"kind": "ramp", "amplitude_deg": 120.0, "rise_time": 1.0, "duration": 1.0},
    "sine_0p5hz": {"kind": "sine", "amplitude_deg": 60.0, "frequency_hz": 0.5, "duration": 4.0},
    "cycloid_pos": {"kind": "cycloid", "amplitude_deg": 120.0, "rise_time": 1.0, "duration": 2.0},
    "cycloid_neg": {"kind": "cycloid", "amplitude_deg": -120.0, "rise_time": 1.0, "duration": 2.0},
}


GROUPS = ("trajectory", "controller", "payload", "orientation", "pump", "amplifier", "tubing", "friction")


@lru_cache(maxsize=1)
def composer() -> Composer:
    return Composer()


@lru_cache(maxsize=256)
def attached(*overrides: str) -> bytes:
    """Return the resolved configuration of a condition as a log has it."""
    composition = composer().compose(overrides)
    config = {key: value for key, value in composition.config.items() if isinstance(value, dict)}
    for group, choice in composition.choices.items():
        if group in config:
            config[group].setdefault("name", choice)
    config["controller_model"] = composer().model(str(config["controller"]["model"]))
    return yaml.safe_dump({**config, "repetitions": 7, "seed": 1}).encode()


def make_log(
    trajectory: str,
    controller: str = "pid",
    repetition: int = 1,
    error_deg: float = 1.0,
    overrides: tuple[str, ...] = (),
    **metadata: str,
) -> TestLog:
    """Return a log whose arm lags by ``error_deg`` (plus 0.1 deg per repetition) all the time.

    Its configuration is that of its choices under ``overrides``.
    """
    shape = build_trajectory(SHAPES[trajectory])
    time = np.arange(-400, round(shape.duration * 1000)) / 1000.0
    reference = np.degrees(shape.reference(time)[0])
    lag = np.full(time.size, error_deg + 0.1 * repetition)
    lag[time < 0] = 50.0  # what happens before the command phase must not count
    columns = {
        "time_s": time,
        "phase": np.where(time < 0, 2.0, 3.0),
        "reference_deg": reference,
        "arm_deg": reference - lag,
        "pressure1_mpa": np.full(time.size, 0.3),
        "pressure2_mpa": np.full(time.size, 0.2),
        "command_deg": 8.5 * reference,
        "pump_deg": 8.5 * reference,
    }
    named = {
        "campaign": "controllers",
        "condition": f"{trajectory}__{controller}",
        "trajectory": trajectory,
        "controller": controller,
        "payload": "none",
        "orientation": "horizontal",
        "pump": "pump2",
        "amplifier": "high_gain",
        "tubing": "ldpe_300mm",
        "friction": "bidirectional",
        "repetition": str(repetition),
    }
    named |= metadata
    choices = [f"{group}={named[group]}" for group in GROUPS if named[group] in composer().options(group)]
    attachments = {"config.yaml": attached(*choices, *overrides)}
    return TestLog(columns=columns, metadata=named, attachments=attachments)


def make_logs(repetitions: int = 3) -> list[TestLog]:
    """Return two trajectories times two controllers."""
    return [
        make_log(trajectory, controller, repetition, 0.5 if controller == "ffwd_pid" else 1.5)
        for trajectory in ("ramp_pos", "cycloid_pos")
        for controller in ("pid", "ffwd_pid")
        for repetition in range(1, repetitions + 1)
    ]
