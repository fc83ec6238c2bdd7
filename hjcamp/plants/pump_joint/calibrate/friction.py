"""Static, Coulomb and viscous friction of each direction from ramps of the pump at several speeds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.plants.pump_joint.calibrate.constants import Constants
from hjcamp.plants.pump_joint.calibrate.estimate import LEVEL, Chart, Estimate, Finding, Series, mean_interval
from hjcamp.plants.pump_joint.calibrate.friction_scatter import friction_scatter
from hjcamp.plants.pump_joint.calibrate.plateaus import STICKS, Breakaway, Plateau, Shown, per_test, read_strokes
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
DIRECTIONS = (("positive", 1.0), ("negative", -1.0))
FEWEST_SPEEDS = 3
SPEED_RATIO = 1.15  # plateaus whose speeds differ by less are one speed
MOST = 0.7
VAPOUR_MPA = -0.09
SLOW_RISE = 0.01  # of the breakaway force, in one sample


def identify_friction(logs: Sequence[TestLog], constants: Constants) -> Finding:
    """Return static, Coulomb and viscous friction for each direction.

    Static: mean force at breakaway. Coulomb and viscous: the line F = F_c + C_v v through the steady strokes.
    Raises UsageError where there is no steady stroke, or too few speeds. Source: thesis 4.5.1, appendix A; line by
    scipy.stats.linregress.
    """
    shown = [read_strokes(log, number, constants) for number, log in enumerate(logs)]
    plateaus = steady_speeds(shown)
    if not plateaus:
        raise UsageError(_nothing_steady(logs, shown))
    repeated = len(logs) > len({log.condition_key for log in logs})
    estimates: list[Estimate] = []
    warnings: list[str] = []
    for name, sign in DIRECTIONS:
        broke = [one for test in shown for one in test.breakaways if one.direction == sign]
        estimates += _static(name, broke, constants, repeated, warnings)
        own = [one for one in plateaus if one.direction == sign]
        estimates += _line(name, own, constants, repeated, warnings, left_out(shown))
    named = {one.name: one.value for one in estimates}
    lines = {
        sign: (named[f"coulomb_{name}"], named[f"viscous_{name}"])
        for name, sign in DIRECTIONS
        if named.get(f"coulomb_{name}", 0.0) > 0
    }
    estimates += friction_scatter(plateaus, lines) if repeated else []
    if left_out(shown):
        warnings.append(f"strokes were left out: {left_out(shown)}")
    parted = sum(_parted(log) for log in logs)
    if parted:
        warnings.append(f"in {counted(parted, 'test')} a line ran down to its vapour pressure; preload more")
    if any(log.metadata.get("orientation") == "vertical" and log.metadata.get("payload") != "none" for log in logs):
        warnings.append("a payload on a vertical arm pulls too: what is called friction holds its weight")
    facts = {"strokes at constant speed": str(len(plateaus))}
    return Finding("friction", tuple(estimates), _charts(logs, shown, estimates, constants), tuple(warnings), facts)


def steady_speeds(shown: Sequence[Shown]) -> list[Plateau]:
    """Return the plateaus of those speeds at which most strokes are steady.

    Where most stick and slip, those that do not are the ones of low friction: to keep them alone would be a bias.
    """
    kept: dict[tuple[float, int], list[Plateau]] = {}
    stuck: Counter[tuple[float, int]] = Counter()
    for test in shown:
        for one in test.plateaus:
            kept.setdefault((one.direction, speed_class(one.speed)), []).append(one)
        stuck.update((one.direction, speed_class(one.speed)) for one in test.refused if one.reason == STICKS)
    return [one for key, own in kept.items() if len(own) >= MOST * (len(own) + stuck[key]) for one in own]


def speed_class(speed: float) -> int:
    """Return the number of the class of speeds, each 15 % wide."""
    return round(float(np.log(speed) / np.log(SPEED_RATIO)))


def _parted(log: TestLog) -> bool:
    columns = log.command_phase
    return min(float(columns["pressure1_mpa"].min()), float(columns["pressure2_mpa"].min())) < VAPOUR_MPA


def left_out(shown: Sequence[Shown]) -> str:
    """Return why strokes are no plateaus, and how many; empty where all are."""
    refused = Counter(one.reason for test in shown for one in test.refused)
    return ", ".join(f"{reason} ({count})" for reason, count in refused.most_common())


def _nothing_steady(logs: Sequence[TestLog], shown: Sequence[Shown]) -> str:
    reasons = left_out(shown) or "the pump's speed changes"
    return (
        f"no constant-speed segment in {len(logs)} friction tests: {reasons}. Ramps of the pump are needed, "
        "see campaign=friction"
    )


def _static(name: str, broke: Sequence[Breakaway], constants: Constants, repeated: bool, warnings: list[str]) -> list[Estimate]:
    if not broke:
        warnings.append(f"no breakaway in the {name} direction: static friction is not identified")
        return []
    least = min(one.rise / one.force for one in broke)
    slow = [one for one in broke if one.rise <= max(SLOW_RISE, 1.5 * least) * one.force]
    if least > 2.0 * SLOW_RISE:
        warnings.append(f"{name}: the force rises by {least * 100:.1f} % a sample before breakaway; ramp more slowly")
    values = per_test([(one.test, one.force) for one in slow])
    mean, interval = mean_interval(values)
    key = f"static_{name}"
    text = f"static friction, {name}"
    known = constants.published.get(key)
    return [Estimate(key, mean, "N", interval if repeated else None, len(values), text, "N", 1.0, known)]


def speeds_among(values: Sequence[float]) -> int:
    """Return how many different speeds there are; those within 15 % are one."""
    count, last = 0, 0.0
    for value in sorted(values):
        if value > SPEED_RATIO * last:
            count, last = count + 1, value
    return count


def _line(
    name: str, plateaus: Sequence[Plateau], constants: Constants, repeated: bool, warnings: list[str], missing: str
) -> list[Estimate]:
    from scipy.stats import linregress, t

    if not plateaus:
        warnings.append(f"no constant-speed segment in the {name} direction: Coulomb and viscous friction are missing")
        return []
    speeds = speeds_among([one.speed for one in plateaus])
    if speeds < FEWEST_SPEEDS:
        raise UsageError(
            f"too few speeds in the {name} direction: {speeds} where {FEWEST_SPEEDS} are needed to tell Coulomb from "
            f"viscous friction; add ramps at other speeds{f' (left out: {missing})' if missing else ''}"
        )
    points = means_of_tests(plateaus)
    line = linregress(points[:, 0], points[:, 1])
    reach = float(t.ppf(0.5 + LEVEL / 2, max(len(points) - 2, 1)))
    if line.slope < 0:
        warnings.append(f"{name}: friction falls with speed; a line is not its law (see effect stribeck_friction)")
    found = []
    for key, value, error, unit, text, shown, scale in (
        (f"coulomb_{name}", line.intercept, line.intercept_stderr, "N", f"Coulomb friction, {name}", "N", 1.0),
        (f"viscous_{name}", line.slope, line.stderr, "N*s/m", f"viscous friction, {name}", "N·s/mm", 1e-3),
    ):
        interval = (value - reach * error, value + reach * error) if repeated else None
        known = constants.published.get(key)
        found.append(Estimate(key, float(value), unit, interval, len(points), text, shown, scale, known))
    if not repeated:
        warnings.append(f"{name}: one repetition only, so no interval")
    return found


def means_of_tests(plateaus: Sequence[Plateau]) -> Array:
    """Return speed (m/s) and force (N) of each test and speed (n, 2): strokes of one test are no repetitions."""
    groups: dict[tuple[int, int], list[Plateau]] = {}
    for one in plateaus:
        groups.setdefault((one.test, speed_class(one.speed)), []).append(one)
    return np.array([[np.mean([p.speed for p in own]), np.mean([p.force for p in own])] for own in groups.values()])


def _charts(
    logs: Sequence[TestLog], shown: Sequence[Shown], estimates: Sequence[Estimate], constants: Constants
) -> tuple[Chart, ...]:
    named = {one.name: one.value for one in estimates}
    charts = []
    for (name, sign), figure in zip(DIRECTIONS, ("4.5.3, A.1", "4.5.3, A.2"), strict=True):
        points = [one for test in shown for one in test.plateaus if one.direction == sign]
        if not points or f"coulomb_{name}" not in named:
            continue
        x, y = np.array([one.speed for one in points]) * 1e3, np.array([one.force for one in points])
        ends = np.array([0.0, float(x.max())])
        line = named[f"coulomb_{name}"] + named[f"viscous_{name}"] * ends * 1e-3
        label = f"{named[f'coulomb_{name}']:.3g} N + {named[f'viscous_{name}'] * 1e-3:.3g} N·s/mm v"
        series = (Series(x, y, "strokes at constant speed", "points"), Series(ends, line, label, "dashed", 1))
        caption = f"Coulomb and viscous friction against slider speed, {name} direction"
        charts.append(Chart(f"friction_{name}", figure, caption, "Slider speed (mm/s)", "Friction (N)", series))
    number = min(range(len(logs)), key=lambda index: (not shown[index].plateaus, -logs[index].duration))
    columns = logs[number].command_phase
    difference = (columns["pressure1_mpa"] - columns["pressure2_mpa"]) * 1e6 * constants.joint_area
    travel = np.radians(columns["arm_deg"]) * constants.pulley_radius * 1e3
    every = max(len(difference) // 1500, 1)
    time = columns["time_s"][::every]
    charts.append(
        Chart(
            "friction_test",
            "4.5.1",
            "Force of the lines and travel of the sliders in one test",
            "Time (s)",
            "Force (N), travel (mm)",
            (Series(time, difference[::every], "(p1 − p2) A₂ (N)"), Series(time, travel[::every], "travel (mm)", "line", 1)),
        )
    )
    return tuple(charts)
