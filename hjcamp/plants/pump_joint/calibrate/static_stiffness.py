"""Static stiffness of the joint from tests in which a force is put on the arm: what each line bears, what friction holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Series
from hjcamp.plants.pump_joint.sizing.stiffness import arm_stiffness, line_compliances, locked_stiffness, shares
from hjcamp.plants.pump_joint.sizing.tubing import ATMOSPHERE, tubing_modulus, tubing_volume
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
FORCE = "force_step"
WINDOW_S = 0.1  # a mean over this long, at the end of each state
FEWEST_COUNTS = 3.0  # of the arm encoder: less is no motion
NEAR_DEG = 1.0


@dataclass(frozen=True)
class Step:
    """One test: force (N), what the arm gave way (m at the sliders), the force back of each line (N), largest angle, return.

    ``returned`` is the time in s from the force to where the arm stays within 1 deg of where it was; None where it does not.
    """

    case: str
    locked: bool
    force: float
    travel: float
    lines: tuple[float, float]
    largest_deg: float
    returned: float | None
    config: Mapping[str, Any]

    @property
    def moved(self) -> bool:
        """Whether the arm moved by more than a few counts of its encoder."""
        counts = float(self.config["rig"]["sensors"]["encoder_counts_per_turn"])
        return abs(self.travel) >= FEWEST_COUNTS * 2.0 * math.pi / counts * _radius(self.config)

    @property
    def left_deg(self) -> float:
        """The angle of the arm at the end of the force, deg."""
        return math.degrees(self.travel / _radius(self.config))

    @property
    def held(self) -> float:
        """What friction holds of the force, N without sign."""
        return abs(self.force) - abs(sum(self.lines))


@dataclass(frozen=True)
class Stiffness:
    """A case with the pump at rest: stiffness at the sliders with its standard error, and each line's part of it, N/m."""

    case: str
    tests: int
    still: int
    value: float
    error: float
    lines: tuple[float, float]
    expected: float
    parts: Mapping[str, float]
    held: float
    radius: float

    def words(self) -> str:
        """Return the case as a sentence."""
        further = 1.0 / self.value - 1.0 / self.expected
        made = ", ".join(f"{name} {share:.0%}" for name, share in self.parts.items())
        text = (
            f"{self.case}: {self.value / 1e3:.2f} ± {self.error / 1e3:.2f} N/mm at the sliders, "
            f"{arm_stiffness(self.value, self.radius) * 1e3:.1f} mN m/rad at the arm; by hand (K1 + K2) A2² = "
            f"{self.expected / 1e3:.2f} N/mm; line 1 bears {self.lines[0] / sum(self.lines):.0%}, line 2 "
            f"{self.lines[1] / sum(self.lines):.0%}; friction holds {self.held:.1f} N; further compliance "
            f"{further * 1e6:.1f} ± {self.error / self.value**2 * 1e6:.1f} µm/N; a line gives way by {made}"
        )
        return text + (f"; in {self.still} of {self.tests} tests the arm did not move" if self.still else "")


def step_of(log: TestLog, config: Mapping[str, Any]) -> Step:
    """Return what one log of a force step tells; ``UsageError`` where it does not say when the force came and went."""
    given = (config.get("effects") or {}).get(FORCE)
    if not given or not {"strength", "begin", "end"} <= set(given):
        raise UsageError(f"{log.condition_key}: effects.{FORCE} needs strength, begin and end, which say what was put on")
    command = log.command_phase
    time, arm = command["time_s"], command["arm_deg"]
    begin, end = float(given["begin"]), float(given["end"])
    before, loaded = (time < begin) & (time >= begin - WINDOW_S), (time < end) & (time >= end - WINDOW_S)
    on = (time >= begin) & (time < end)
    if not before.any() or not loaded.any() or end - begin < 2.0 * WINDOW_S or time[-1] < end - WINDOW_S:
        raise UsageError(
            f"{log.condition_key}: the force is on from {begin:g} to {end:g} s; the test needs {WINDOW_S:g} s before it, "
            f"and the force {2.0 * WINDOW_S:g} s, within its {time[-1]:.3g} s"
        )

    def change(name: str) -> float:
        return float(command[name][loaded].mean() - command[name][before].mean())

    area = math.pi / 4.0 * (float(config["joint"]["bore_mm"]) * 1e-3) ** 2
    lines = -change("pressure1_mpa") * 1e6 * area, change("pressure2_mpa") * 1e6 * area
    away = np.abs(arm[on] - arm[before].mean())
    outside = np.flatnonzero(away > NEAR_DEG)
    last = int(outside[-1]) + 1 if outside.size else 0
    controller = str(config["controller"]["name"])
    tubing = str(config["tubing"]["name"])
    return Step(
        case=tubing if controller == "open_loop" else f"{tubing}, loop with {controller}",
        locked=controller == "open_loop",
        force=float(given["strength"]),
        travel=math.radians(change("arm_deg")) * _radius(config),
        lines=lines,
        largest_deg=float(away.max()),
        returned=None if last >= away.size else float(time[on][last] - begin),
        config=config,
    )


def steps_of(logs: Iterable[TestLog], configuration: Mapping[str, Mapping[str, Any]]) -> list[Step]:
    """Return the step of each log; ``configuration`` is the configuration of each condition."""
    return [step_of(log, configuration[log.condition_key]) for log in logs]


def stiffness_of(steps: Sequence[Step]) -> Stiffness | None:
    """Return the stiffness of one case by least squares through the origin, force of the lines over travel of the arm.

    Tests in which the arm did not move are left out; None where no two are left.
    """
    moved = [one for one in steps if one.moved]
    if len(moved) < 2:
        return None
    travel = np.array([one.travel for one in moved])
    lines = np.array([one.lines for one in moved])
    squares = float(travel @ travel)
    value = float(travel @ lines.sum(axis=1)) / squares
    left = lines.sum(axis=1) - value * travel
    config = moved[0].config
    tubing = config["tubing"]
    stiffness = float(tubing["stiffness_mpa_per_mm3"]) * 1e15
    area = math.pi / 4.0 * (float(config["joint"]["bore_mm"]) * 1e-3) ** 2
    return Stiffness(
        case=moved[0].case,
        tests=len(steps),
        still=len(steps) - len(moved),
        value=value,
        error=math.sqrt(float(left @ left) / (len(moved) - 1) / squares),
        lines=(float(travel @ lines[:, 0]) / squares, float(travel @ lines[:, 1]) / squares),
        expected=locked_stiffness(stiffness, stiffness, area),
        parts=shares(_compliances(config, stiffness)),
        held=float(np.mean([one.held for one in moved])),
        radius=_radius(config),
    )


def _compliances(config: Mapping[str, Any], stiffness: float) -> dict[str, float]:
    """Return the compliances of a line: water and wall from its size, air too or, where it is not stated, the rest."""
    tubing = config["tubing"]
    inner, outer = float(tubing["inner_diameter_mm"]) * 1e-3, float(tubing["outer_diameter_mm"]) * 1e-3
    wall = tubing_modulus(inner, outer, float(tubing["youngs_modulus_mpa"]) * 1e6, float(tubing["poisson_ratio"]))
    volume = tubing_volume(inner, float(tubing["length_mm"]) * 1e-3)
    preload = float(config["procedure"]["preload_mpa"]) * 1e6 + ATMOSPHERE
    parts = line_compliances(volume, float(tubing["water"]["bulk_modulus_mpa"]) * 1e6, wall, 0.0, preload)
    del parts["air"]
    left = 1.0 / stiffness - sum(parts.values())
    return {**parts, "air and fittings": left} if left > 0.0 else parts


def stiffness_charts(steps: Sequence[Step]) -> tuple[str, list[Chart]]:
    """Return sentences on each case, and two charts: force of the lines over travel, and the angle left over the force."""
    cases: dict[str, list[Step]] = {}
    for one in steps:
        cases.setdefault(one.case, []).append(one)
    said, drawn, angles = [], [], []
    for number, own in enumerate([own for own in cases.values() if own[0].locked]):
        found = stiffness_of(own)
        if found is None:
            said.append(f"{own[0].case}: in no two tests the arm moved; the force must exceed the static friction")
            continue
        said.append(found.words())
        x = np.array([one.travel for one in own]) * 1e3
        drawn.append(Series(x, np.array([sum(one.lines) for one in own]), found.case, "points", number))
        ends = np.array([min(0.0, x.min()), max(0.0, x.max())])
        drawn.append(Series(ends, ends * found.expected * 1e-3, f"{found.case}, by hand", "dashed", number))
    for number, (case, own) in enumerate(cases.items()):
        order = sorted(own, key=lambda one: one.force)
        force = np.array([one.force for one in order])
        angles.append(Series(force, np.array([one.left_deg for one in order]), case, "points", number))
        if not own[0].locked:
            said.append(_loop_words(case, own))
    charts = []
    if drawn:
        name = "Force that the lines bear over what the arm gives way"
        charts.append(Chart("stiffness", "", name, "Travel at the sliders (mm)", "Change of (p2 - p1) A2 (N)", tuple(drawn)))
    name = "Residual angle at the end of the force"
    charts.append(Chart("left", "", name, "Force at the sliders (N)", "Residual angle (deg)", tuple(angles)))
    return "; ".join(said), charts


def _loop_words(case: str, own: Sequence[Step]) -> str:
    back = [one.returned for one in own if one.returned is not None]
    text = f"{case}: largest angle {max(one.largest_deg for one in own):.1f} deg"
    if back:
        text += f", back within {NEAR_DEG:g} deg after {np.median(back):.2f} s (median)"
    return text + (f", not back in {len(own) - len(back)} of {len(own)} tests" if len(back) < len(own) else "")


def _radius(config: Mapping[str, Any]) -> float:
    return float(config["joint"]["pulley_pitch_diameter_mm"]) * 0.5e-3
