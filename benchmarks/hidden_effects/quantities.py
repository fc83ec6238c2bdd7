"""The measures of the hidden-effect benchmark that compare numbers: errors removed, amplitudes, intervals, times."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from truth.pump_joint.case import CONTACTS

from benchmarks.hidden_effects.amplitudes import AMPLITUDES, amplitude_of, true_base
from benchmarks.hidden_effects.judging import Line, named, right
from benchmarks.hidden_effects.measure import Aim, Measure, at_least, at_most, counted

# Cases with less to remove say nothing about the share that is removed.
REMOVABLE = 1.1


def removed(lines: Sequence[Line], nulls: Sequence[Line]) -> list[Measure]:
    """Return the share of the removable held-out error that the answer removes, against three measures of the best possible.

    What nothing hidden leaves differs with the contact: bristles and a force that is smooth in speed leave more.
    """
    bare = {contact: _baseline(x for x in nulls if contact in ("", x.get("contact"))) for contact in ("", *CONTACTS)}
    references: dict[str, Callable[[Line], float]] = {"floor 1": lambda line: 1.0}
    if bare[""]:
        # what the calibrated model leaves on rigs with nothing hidden, in units of the floor
        references = {
            "what nulls with the same contact leave": lambda line: bare.get(line.get("contact", "")) or bare[""],
            f"what nulls leave, {bare['']:.2f} x noise floor": lambda line: bare[""],
            **references,
        }
    rows = []
    for text, best in references.items():
        shares = []
        for line in lines:
            error = line["answer"]["error"] if "answer" in line else {"baseline": None}
            if error["baseline"] is not None and error["baseline"] > REMOVABLE * best(line):
                left = error["augmented"] if error["augmented"] is not None else error["baseline"]
                shares.append((error["baseline"] - left) / (error["baseline"] - best(line)))
        for title, level, aim in (
            ("median", 50, at_least("0.96", 0.95, 0.97)),
            ("10th percentile", 10, at_least("0.45", 0.7, 0.9)),
        ):
            value = float(np.percentile(shares, level)) if shares else math.nan
            name = f"share of the removable held-out error removed, {title} (best: {text})"
            rows.append(Measure(name, value, len(shares), aim, unit=""))
    return rows


def _baseline(lines: Iterable[Line]) -> float:
    """Return the median error over the floor that the calibrated model leaves, 0 where none is known."""
    known = [float(x["answer"]["error"]["baseline"]) for x in lines if "answer" in x and x["answer"]["error"]["baseline"]]
    return float(np.median(known)) if known else 0.0


def amplitudes(lines: Sequence[Line]) -> list[Measure]:
    """Return the median error of the amplitudes of effects that were named."""
    errors: dict[bool, list[float]] = {True: [], False: []}
    for line in lines:
        for effect in line["effects"]:
            found = amplitude_of(line, effect) if effect in named(line) else None
            if found is not None:
                errors[AMPLITUDES[effect].same].append(100 * abs(found[0] - found[1]) / abs(found[0]))
    aim = at_most("2 - 8 %", 5, 3)
    every = errors[True] + errors[False]
    return [
        Measure("amplitude error, median (same quantity)", _median(errors[True]), len(errors[True]), aim),
        Measure("... with those of a differing law", _median(every), len(every), aim),
    ]


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else math.nan


def coverage(library: Sequence[Line], nulls: Sequence[Line]) -> list[Measure]:
    """Return how often the 95 % intervals hold the truth, where the verdict was right."""
    bare: list[tuple[str, bool]] = []
    beside: list[tuple[str, bool]] = []
    hidden: list[tuple[str, bool]] = []
    widths: list[float] = []
    for line in [*nulls, *library]:
        if "answer" not in line or not right(line, False):
            continue
        (bare if line["kind"] == "null" else beside).extend(base_covered(line).items())
        for effect in line["effects"]:
            found = amplitude_of(line, effect)
            if found is not None and found[2] is not None:
                hidden.append((effect, found[2]))
                widths.append(_half_of_amplitude(line, effect))
    aim = Aim("not tried", (85, 99), (93, 97))
    return [
        _covered("coverage of 95 % intervals, base parameters and amplitudes", bare + beside + hidden, aim),
        _covered("... base parameters, nulls", bare, aim),
        _covered("... base parameters beside a right effect", beside, aim),
        # a force that is smooth in speed has no static friction, and bristles creep before they slip
        _covered(
            "... base parameters but static friction, nulls and right effects",
            [row for row in bare + beside if not row[0].startswith("static_")],
            aim,
        ),
        _covered("... amplitudes of right effects", hidden, aim),
        Measure("half width of these intervals of amplitudes, median", _median(widths), len(widths), at_most("19 %", 12, 8)),
        half_width([line for line in library if "answer" in line and right(line, False)]),
    ]


def _half_of_amplitude(line: Line, effect: str) -> float:
    """Return half the width of the 95 % interval of an amplitude that can be compared, over its value, percent."""
    single = AMPLITUDES[effect].single
    row = next(one for one in line["answer"]["candidates"] if one["effect"] == effect)["parameters"][single]
    low, high = row["ci95"]
    return float(50.0 * (high - low) / abs(row["value"]))


def half_width(lines: Sequence[Line]) -> Measure:
    """Return half the width of the 95 % intervals of effects that are right, over their value, percent: the median.

    It is that of what an effect makes at the tests' own operating point, also of those of which no number means the same in both laws:
    their form is that of all effects together. What is known exactly, to a count, is no width.
    """
    widths = []
    for line in lines:
        for row in line["answer"]["candidates"]:
            found = row.get("functional") if row["effect"] in line["effects"] else None
            low, high = (found or {}).get("ci95") or (None, None)
            if found and found["value"] and low is not None and high is not None:
                widths.append(50.0 * (high - low) / abs(found["value"]))
    title = "... of what all right effects make at the tests' operating point"
    return Measure(title, _median(widths), len(widths), at_most("19 %", 12, 8))


def _covered(title: str, rows: Sequence[tuple[str, bool]], aim: Aim) -> Measure:
    spoiled = Counter(name for name, ok in rows if not ok)
    return counted(title, sum(ok for _, ok in rows), len(rows), aim, tuple(spoiled.most_common()))


def base_covered(line: Line) -> dict[str, bool]:
    """Return for each base parameter of a result whether its interval holds the truth."""
    rows = line["answer"]["calibration"]
    found = {}
    for name, value in true_base(line).items():
        low, high = rows.get(name, {}).get("ci95", (None, None))
        if low is not None and high is not None:
            found[name] = bool(low <= value <= high)
    return found


def times(lines: Sequence[Line], effort: str) -> list[Measure]:
    """Return the median time of a diagnosis in one process with one thread; kernels of other libraries compile anew."""
    chosen = [line for line in lines if line["effort"] == effort and line["kind"] != "taken_out" and "answer" in line]
    title = f"time for 24 tests and 22 effects, {effort}, one thread, median"
    wall = [float(line["seconds"]) for line in chosen]
    busy = [float(line["processor_seconds"]) for line in chosen]
    return [
        Measure(title, _median(wall), len(wall), at_most("24 s", 60, 15), unit="s"),
        Measure(f"... of processor time, {effort}", _median(busy), len(busy), unit="s"),
    ]
