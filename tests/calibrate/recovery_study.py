"""Twenty simulated rigs with parameters drawn at random: does the calibration find them? Prints Markdown.

make recovery, or: python tests/calibrate/recovery_study.py [RIGS] > docs/identification_recovery.md
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from random_rigs import CAMPAIGNS, RandomRig, draw_rig, run_campaign  # noqa: E402

from hjcamp.configuration.composer import Composer  # noqa: E402
from hjcamp.configuration.setups import configuration_for  # noqa: E402
from hjcamp.plants.pump_joint.calibrate.estimate import Estimate  # noqa: E402
from hjcamp.plants.pump_joint.calibrate.identify import Calibration, identify  # noqa: E402

RIGS = 20
LEVEL_KPA = {"leak_rate_620_kpa": 0.62e6, "leak_rate_600_kpa": 0.60e6, "leak_rate_560_kpa": 0.56e6}


def full_truth(rig: RandomRig) -> dict[str, float]:
    """Return the true values with the rates of leakage that follow from them."""
    truth = dict(rig.truth)
    for name, level in LEVEL_KPA.items():
        extra = truth["leakage.conductance_above"] * max(level - truth["leakage.threshold"], 0.0)
        truth[name] = truth["line_stiffness"] * (truth["leakage.conductance"] * level + extra)
    return truth


def step_error(calibration: Calibration, truth: dict[str, float]) -> float:
    """Return the largest difference of the identified and the true response to a step, share of full scale."""
    from scipy.signal import lti, step

    time = np.arange(0.0, 0.3, 1e-4)
    found = {name: one.value for name, one in calibration.estimates.items()}
    curves = []
    for values in (found, truth):
        system = lti([values["pump_gain"]], [1.0, values["pump_a2"], values["pump_a1"], values["pump_a0"]])
        curve = step(system, T=time)[1]
        curves.append(np.interp(time - values["pump_delay"], time, curve, left=0.0))
    return float(np.max(np.abs(curves[0] - curves[1])) / curves[1][-1])


def study(rigs: int) -> str:
    """Return the table of the study."""
    composer = Composer()
    rows: dict[str, list[tuple[float, bool, float]]] = {}
    orders, steps = [], []
    for number in range(rigs):
        rig = draw_rig(number)
        logs = [log for campaign in CAMPAIGNS for log in run_campaign(campaign, rig.overrides, composer)]
        calibration = identify(logs, configuration_for)
        truth = full_truth(rig)
        for name, one in calibration.estimates.items():
            if name in truth:
                rows.setdefault(name, []).append(judged(one, truth[name]))
        orders.append(calibration.findings["pump_step"].facts["order chosen"])
        steps.append(step_error(calibration, truth))
        print(f"rig {number}: order {orders[-1]}, step {steps[-1]:.2%}", file=sys.stderr)
    return page(rigs, rows, orders, steps)


def judged(one: Estimate, truth: float) -> tuple[float, bool, float]:
    """Return relative error, whether the interval covers the truth, and the interval's relative half width."""
    low, high = one.interval or (math.nan, math.nan)
    return one.value / truth - 1.0, low <= truth <= high, (high - low) / 2.0 / truth


def page(rigs: int, rows: dict[str, list[tuple[float, bool, float]]], orders: list[str], steps: list[float]) -> str:
    """Return the Markdown page."""
    covered = [one[1] for values in rows.values() for one in values]
    lines = [
        f"# Calibration of {rigs} simulated rigs drawn at random",
        "",
        "Made by `make recovery` (`python tests/calibrate/recovery_study.py`). Every rig has its own friction (each",
        "direction), dp/dV, pump, leak, noise and scatter; 70 test logs each: campaigns `pump_step`, `compliance`,",
        "`leakage` and `friction` with 7 repetitions, without the configuration that made them. Delays are whole ms.",
        "",
        f"* The 95 % intervals cover the truth in {np.mean(covered):.0%} of {len(covered)} cases (asked: 85 to 100 %).",
        f"* Order 3 is chosen for {orders.count('3')} of {rigs} pumps (asked: at least 18 of 20).",
        f"* The identified step responses are within {max(steps):.2%} of full scale (asked: 1 %).",
        "",
        "| parameter | rigs | median error | largest error | half width of the interval | truth covered |",
        "|---|---|---|---|---|---|",
    ]
    for name, values in rows.items():
        errors = np.abs([one[0] for one in values])
        widths, hits = [one[2] for one in values], [one[1] for one in values]
        lines.append(
            f"| `{name}` | {len(values)} | {np.median(errors):.2%} | {errors.max():.2%} | {np.nanmedian(widths):.2%} | "
            f"{sum(hits)} of {len(hits)} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(study(int(sys.argv[1]) if len(sys.argv) > 1 else RIGS))
