"""What a diagnosis of any plant says of what is no effect: a swing from outside, a base that differs between conditions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp.diagnosis.calibration.shares import left_of
from hjcamp.diagnosis.levels import DELTA
from hjcamp.model.declare.base_values import DELAY
from hjcamp.report.wording.units import plain, told, told_estimate, told_interval, told_like

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect


def swing_words(row: Mapping[str, Any]) -> str:
    """Say what oscillates by itself, how much of the error that is, and by what chance it would be there."""
    from hjcamp.report.wording.channels import channel_label

    return (
        f"The free-run error of {channel_label(row['channel'])} contains an oscillation at {plain(row['frequency_hz'], 4)} Hz, "
        f"{told(row['rms'], row['unit'])} rms, that no input contains: a force, a flow or a disturbance from outside. "
        f"Without it {100.0 * row['left']:.0f} % of the error remains (chance: p = {plain(row['chance'], 2)})."
    )


def by_condition_words(row: Mapping[str, Any], before: float) -> list[str]:
    """Say what a base for each condition leaves, and which parameters differ."""
    similar: dict[str, list[str]] = {}
    for name, found in row["parameters"].items():
        values: dict[str, list[str]] = {}
        for condition, one in found["conditions"].items():
            value = told(one["value"], found["unit"]) if one.get("told", True) else "not identifiable"
            values.setdefault(value, []).append(condition)
        label = name.replace("_", " ").replace(DELAY, "delay of ")
        similar[label] = [f"{value} in {' and '.join(where)}" for value, where in values.items()]
    each = "; ".join(f"{label} is {', '.join(said)}" for label, said in similar.items())
    return [
        "No one set of parameters fits all conditions. Estimated for each alone, they leave "
        f"{plain(row['left'])} times the noise floor instead of {plain(before)}: {each}.",
        "What is known to differ can be given with each test: Parameter(..., given=NAME), and NAME in the metadata of its log. "
        "Logs of several specimens are diagnosed one specimen at a time.",
    ]


def constant_words(rows: Mapping[str, Mapping[str, Any]], before: float) -> list[str]:
    """Say which constant of the plant's file may be another one, next to the error of the base ``before``, over the noise floor."""
    said = []
    for name, one in rows.items():
        label = name.replace("_", " ")
        said.append(
            f"The plant's file gives {label} as {told_like(one['declared'], one)}. With {told_estimate(one)} "
            f"({told_interval(one)}) and nothing else the error is {one['left']:.2f} times the noise floor instead of "
            f"{before:.2f}: if it is not known so well, write base=True at {name} and ask again."
        )
    return said


def over_time_words(row: Mapping[str, Any], repeated: bool) -> list[str]:
    """Say what a non-parametric term over time may be where no test was repeated, and what to do where conditions differ in it."""
    if row["driver"] != "time":
        return []
    memory = (
        "Without repetitions, a dependence on time may also be an unmodelled memory: something that warms, fills or settles with what "
        "was done, where the plant's file has no store or body."
    )
    each = (
        "What comes from outside, as a room or a wind, can be measured and given: an Input(..., field=NAME) of the plant's file, in "
        "its equations."
    )
    return [each] * (row["apart_s"] > 0.0) + [memory] * (not repeated)


def no_memory_words(
    candidates: Sequence[Mapping[str, Any]], library: Mapping[str, type[Effect]], shortest: float = 0.0
) -> list[str]:
    """Say of an effect that would take a share that matters why it is not named: its memory stands at an end of what it may be.

    ``shortest`` is the least that readings resolve, s.
    """
    from hjcamp.diagnosis.candidates.equivalence import memory_end, times_remembered

    said = []
    for one in candidates:
        if left_of(one) > 1.0 - DELTA or one["t"] < one["t_needed"]:
            continue
        for name, bounds in times_remembered(library[one["effect"]]).items():
            if end := memory_end(one["parameters"][name]["ci95"], bounds, shortest):
                how = "depends on the rate" if end == "least" else "depends on the moment alone"
                took = f"{one['effect']} would take {100.0 * (1.0 - left_of(one)):.0f} %"
                said.append(
                    f"{took}, but its {name.replace('_', ' ')} is at the {end} that its bounds or the windows allow: these tests do "
                    f"not show that it remembers, and a law that {how} would do the same."
                )
    return said


def seldom(candidates: Sequence[Mapping[str, Any]], window_s: float) -> list[str]:
    """Return which effect would take most of the error, a share that matters, but in too few parts of the tests to be shown.

    What acts later than a window is long hardly shows in it; a lag has done 95 % after three of its times.
    """
    found = [one for one in candidates if left_of(one) <= 1.0 - DELTA and 0.0 < one["t"] < one["t_needed"]]
    said = []
    for one in sorted(found, key=left_of)[:1]:
        times = [row["value"] for row in one["parameters"].values() if row["unit"] == "s"]
        what = (
            f"a window of {plain(window_s, 2)} s is short relative to its {plain(max(times), 2)} s: longer tests have longer windows."
            if times and 3.0 * max(times) > window_s
            else "record more of the motion in which it acts."
        )
        share = 100.0 * (1.0 - left_of(one))
        said.append(f"{one['effect']} would take {share:.0f} %, but in too few parts of the tests to be shown: {what}")
    return said


def never_alone(library: Mapping[str, type[Effect]]) -> list[str]:
    """Return which effects were not looked for, as they act behind what bends a command and none of that is considered."""
    from hjcamp.diagnosis.candidates.equivalence import is_of_its_own

    kept = [name for name, one in library.items() if one.behind and not is_of_its_own(one, library.values())]
    return [
        f"{name} was not tested: it is only distinguishable after a nonlinearity of its {library[name].behind}, such as a dead band or "
        "a limit, and none is considered here."
        for name in kept
    ]
