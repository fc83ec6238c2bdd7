"""Simulated rigs with parameters drawn at random, and their identification tests, made in memory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.simulation import run_test
from hjcamp.records.log import TestLog

CAMPAIGNS = ("pump_step", "compliance", "leakage", "friction")
LEAST_STATIC = 1.15


@dataclass(frozen=True)
class RandomRig:
    """A rig: the true values (SI, by the names of the estimates) and the overrides that simulate it."""

    number: int
    truth: dict[str, float]
    overrides: tuple[str, ...]


def draw_rig(number: int, seed: int = 2009) -> RandomRig:
    """Draw a rig about the published one: friction, dp/dV, pump, leak, noise and scatter all differ."""
    generator = np.random.default_rng([seed, number])

    def around(value: float, factor: float) -> float:
        return float(value * math.exp(generator.uniform(-math.log(factor), math.log(factor))))

    truth: dict[str, float] = {}
    lines: list[str] = []
    for side, coulomb, viscous in (("positive", 5.27, 23.5), ("negative", 2.97, 17.2)):
        truth[f"coulomb_{side}"] = around(coulomb, 1.5)
        truth[f"static_{side}"] = truth[f"coulomb_{side}"] * generator.uniform(LEAST_STATIC, 1.45)
        truth[f"viscous_{side}"] = around(viscous, 1.4)
        lines += [
            f"friction.{side}.static_n={truth[f'static_{side}']}",
            f"friction.{side}.coulomb_n={truth[f'coulomb_{side}']}",
            f"friction.{side}.viscous_ns_per_mm={truth[f'viscous_{side}'] * 1e-3}",
        ]
    truth["line_stiffness"] = around(2.57e13, 1.5)
    lines.append(f"tubing.stiffness_mpa_per_mm3={truth['line_stiffness'] * 1e-15}")
    lines += _draw_pump(generator, around, truth)
    truth["leakage.conductance"] = around(2e-16, 2.0)
    truth["leakage.threshold"] = float(generator.uniform(0.57e6, 0.61e6))
    truth["leakage.conductance_above"] = around(3.9e-14, 2.0)
    names = ("conductance", "threshold", "conductance_above")
    lines += [f"++effects.leakage.{name}={truth[f'leakage.{name}']}" for name in names]
    lines.append(f"rig.sensors.pressure_noise_mpa={around(7e-4, 1.5)}")
    for name in ("friction_between", "friction_within"):
        lines.append(f"rig.scatter.{name}={generator.uniform(0.01, 0.04)}")
    return RandomRig(number, truth, tuple(lines))


def _draw_pump(generator: Any, around: Any, truth: dict[str, float]) -> list[str]:
    # The published high gain pump: a pole at 105 1/s, a pair of 145 rad/s with damping 0.48, 2 ms of delay.
    pole, frequency, damping = around(105.0, 1.25), around(145.0, 1.15), float(generator.uniform(0.45, 0.7))
    # Whole samples: the simulator blends a fraction of one from two samples, which is no pure delay.
    delay, gain = float(generator.integers(1, 7)), float(generator.uniform(0.97, 1.03))
    a2, a1, a0 = pole + 2 * damping * frequency, frequency**2 + 2 * damping * frequency * pole, pole * frequency**2
    numerator = gain * a0 / 360.0
    truth |= {"pump_gain": numerator * 1e-3 * 180 / math.pi, "pump_a2": a2, "pump_a1": a1, "pump_a0": a0}
    truth["pump_delay"] = delay * 1e-3
    values = {"numerator_mm_per_deg": numerator, "a2": a2, "a1": a1, "a0": a0, "delay_ms": delay}
    return [f"pump.transfer_function.high_gain.{name}={value}" for name, value in values.items()]


def run_campaign(
    campaign: str, overrides: Sequence[str], composer: Composer, repetitions: int = 7, conditions: str = ""
) -> list[TestLog]:
    """Return the logs of a campaign, without an attached configuration: what made them stays hidden."""
    lines = [f"campaign={campaign}", f"repetitions={repetitions}", *overrides]
    lines += [f"conditions={conditions}"] if conditions else []
    if campaign == "pump_step":
        lines += ["pump=pump2", "amplifier=high_gain"]
    plan = make_plan(composer.compose(lines).config, campaign, lines, composer)
    configs = {one.name: one.config for one in plan.conditions}
    logs = []
    for test in plan.tests:
        columns, _ = run_test(configs[test.condition], test.seed)
        named = {"campaign": campaign, "condition": test.condition, "repetition": str(test.repetition)}
        logs.append(TestLog(columns, {**named, "pump": "pump2", "amplifier": "high_gain", "tubing": "ldpe_300mm"}))
    return logs
