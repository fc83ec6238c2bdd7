"""Write docs/convergence.md: the means of every published campaign at the tolerance of a step, a tenth and a hundredth of it.

The encoder counts make a hunting loop chaotic: one test differs, its mean over repetitions may not. Both are said.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.simulation import log_columns, prepare
from hjcamp.records.plan import Plan

CAMPAIGNS = (
    "controllers",
    "robustness_horizontal",
    "robustness_vertical",
    "friction_compliance",
    "feedforward_simulation",
    "open_loop_validation",
)
TOLERANCES = (1.0, 0.1, 0.01)
FIRST = 1000
HEADING = """# Convergence: the tables at a tenth and a hundredth of the tolerance of a step

Made by `make convergence`: {repetitions} repetitions of each test, seed {seed}, model `published`. RMSE1 in degrees,
mean ± standard deviation of the repetitions. `z` is the larger of the two differences from the first mean, over the standard
error of a difference of two means. `to one count` is how many tests agree with those at a hundredth to one count of the encoder
in the first second of the command; `steps` are the steps that one sample takes at each tolerance.

| campaign | condition | tolerance 1 | 1 / 10 | 1 / 100 | z | to one count | steps |
|---|---|---:|---:|---:|---:|---:|---:|
"""
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """One condition: RMSE1 (tolerances, repetitions) in deg, steps a sample, and how many tests agree to one count."""

    campaign: str
    condition: str
    errors: Array
    steps: Array
    agree: int

    @property
    def distance(self) -> float:
        """The larger difference of the means from the first, in standard errors of a difference."""
        count = self.errors.shape[1]
        means, spread = self.errors.mean(axis=1), self.errors.std(axis=1, ddof=1)
        scale = np.sqrt((spread[0] ** 2 + spread[1:] ** 2) / count)
        apart = np.abs(means[1:] - means[0])
        return float(np.max(np.divide(apart, scale, out=np.zeros_like(apart), where=scale > 1e-9)))

    def line(self) -> str:
        """Return the row of the table."""
        means = " | ".join(f"{one.mean():.2f} ± {one.std(ddof=1):.2f}" for one in self.errors)
        steps = ", ".join(f"{one:.2f}" for one in self.steps)
        count = self.errors.shape[1]
        return f"| {self.campaign} | {self.condition} | {means} | {self.distance:.1f} | {self.agree} of {count} | {steps} |"


def planned(campaign: str, repetitions: int, seed: int) -> Plan:
    """Return the plan of a campaign."""
    composer = Composer()
    lines = [f"campaign={campaign}", f"repetitions={repetitions}", f"seed={seed}"]
    return make_plan(composer.compose(lines).config, campaign, lines, composer)


def simulated(config: Any, seed: int, tolerance: float) -> tuple[Array, float, float]:
    """Return the arm angle (n,) in deg during the command, its RMSE1, and the steps that one sample takes."""
    prepared = prepare(config, seed)
    found = prepared.simulator.run(prepared.start, prepared.p, prepared.test, tolerance=tolerance)
    columns = log_columns(found)
    during = columns["phase"] == 3.0
    arm = columns["arm_deg"][during]
    error = float(np.sqrt(np.mean((columns["reference_deg"][during] - arm) ** 2)))
    return arm, error, float(found["steps"]) / len(during)


def rows(campaign: str, repetitions: int, seed: int) -> Iterator[Row]:
    """Yield a campaign's conditions."""
    plan = planned(campaign, repetitions, seed)
    for condition in plan.conditions:
        count = 360.0 / condition.config["rig"]["sensors"]["encoder_counts_per_turn"]
        seeds = [test.seed for test in plan.tests if test.condition == condition.name]
        found = [[simulated(condition.config, one, tolerance) for one in seeds] for tolerance in TOLERANCES]
        agree = sum(
            bool(np.abs(first[0][:FIRST] - last[0][:FIRST]).max() < 1.5 * count)
            for first, last in zip(found[0], found[-1], strict=True)
        )
        errors, steps = (np.array([[test[k] for test in tests] for tests in found]) for k in (1, 2))
        yield Row(campaign, condition.name, errors, steps.mean(axis=1), agree)


def main() -> None:
    """Simulate the campaigns and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", nargs="+", default=CAMPAIGNS, metavar="NAME")
    parser.add_argument("--repetitions", type=int, default=7)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "convergence.md")
    given = parser.parse_args()
    found: list[Row] = []
    for campaign in given.campaigns:
        for row in rows(campaign, given.repetitions, given.seed):
            print(row.line(), flush=True)
            found.append(row)
    far = sum(row.distance > 2.0 for row in found)
    text = HEADING.format(repetitions=given.repetitions, seed=given.seed) + "\n".join(row.line() for row in found)
    text += f"\n\n{far} of {len(found)} conditions are further apart than 2 standard errors"
    text += f" (of as many draws without any difference one expects about {0.09 * len(found):.0f}).\n"
    given.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
