"""Synthetic logs for the tests of the report: small, exact, without noise unless asked for."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hjcamp.configuration.composer import Composer
from hjcamp.records.log import TestLog
from hjcamp.records.plan import Condition, Plan, config_sha256, plan_sha256, planned_tests, seed_of
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


def make_plan(conditions: Sequence[str], repetitions: int = 2, tables: Sequence[str] = (), **words: str) -> Plan:
    """Return a plan of conditions that differ in their names alone."""
    configs = [{"condition": name} for name in conditions]
    made = tuple(
        Condition(name, {}, config, 1.0, config_sha256(config)) for name, config in zip(conditions, configs, strict=True)
    )
    campaign = words.get("campaign", "controllers")
    sha256 = plan_sha256(campaign, tables, repetitions, 1, made)
    tests = planned_tests(conditions, repetitions, 1)
    description = words.get("description", "")
    return Plan(campaign, description, tuple(tables), repetitions, 1, {}, {}, made, tests, sha256)


def write_plan(folder: Path, plan: Plan) -> None:
    """Write ``plan.json``."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "plan.json").write_text(json.dumps(plan.as_json()), encoding="utf-8")


def as_planned(log: TestLog, plan: Plan) -> TestLog:
    """Return a log with what it says of the plan; unchanged where the plan does not have it."""
    for one in plan.conditions:
        if one.name == log.metadata["condition"]:
            seed = seed_of(plan.seed, one.name, int(log.metadata["repetition"]))
            return replace(log, metadata=log.metadata | {"seed": str(seed), "config_sha256": one.sha256})
    return log
