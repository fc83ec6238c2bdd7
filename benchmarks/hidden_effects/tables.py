"""The tables of the hidden-effect benchmark's page, as Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence

from truth.pump_joint.case import CONTACTS
from truth.pump_joint.hidden_law import LAWS

from benchmarks.hidden_effects.amplitudes import AMPLITUDES, LEFT_OUT, amplitude_of
from benchmarks.hidden_effects.cases import LIBRARY_NAMES, OUTSIDE_NAMES, STRENGTHS
from benchmarks.hidden_effects.judging import OUTCOMES, Line, detectable, named, outcome, right, said, visible
from benchmarks.hidden_effects.measure import Aim, Measure

SPOILERS = 4


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(headings) + " |", "|" + "---|" * len(headings)]
    lines += ["| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def measures_table(measures: Sequence[Measure]) -> str:
    """Return the measures beside what they are held against, and the distance."""
    headings = ("measure", "prototype B", "good", "goal", "ours", "cases", "distance; most frequent cases of it")
    rows = []
    for one in measures:
        aims = [bound_text(allowed, one.unit) for allowed in (one.aim.good, one.aim.goal)]
        rows.append((one.title, one.aim.prototype, *aims, value_text(one), str(one.count), distance_text(one)))
    return table(headings, rows)


def number_text(value: float, unit: str) -> str:
    """Return a number with its unit."""
    return f"{value:.3g} {unit}" if unit and unit != "%" else f"{value:.2f}" if not unit else f"{value:.3g} %"


def bound_text(allowed: tuple[float, float] | None, unit: str) -> str:
    """Return a range that is allowed."""
    if allowed is None:
        return ""
    low, high = allowed
    if math.isinf(high):
        return number_text(low, unit)
    return number_text(high, unit) if math.isinf(low) else f"{low:g} - {number_text(high, unit)}"


def value_text(one: Measure) -> str:
    """Return the value, with its interval where it is a share."""
    if not one.count or math.isnan(one.value):
        return "no case"
    text = number_text(one.value, one.unit)
    return text if one.interval is None else f"{text} [{one.interval[0]:.0f}, {one.interval[1]:.0f}]"


def distance_text(one: Measure) -> str:
    """Return how far a measure is from good and from the goal, and the cases that keep it there."""
    aim: Aim = one.aim
    if aim.good is None or aim.goal is None or not one.count or math.isnan(one.value):
        return ""
    if one.meets(aim.goal):
        return "goal met"
    text = "good; goal missed" if one.meets(aim.good) else "good missed"
    allowed = aim.goal if one.meets(aim.good) else aim.good
    gap = allowed[0] - one.value if one.value < allowed[0] else one.value - allowed[1]
    spoiled = ", ".join(f"{name} {count}" for name, count in one.spoiled[:SPOILERS])
    return f"{text} by {number_text(gap, one.unit)}" + (f": {spoiled}" if spoiled else "")


def strengths_table(lines: Sequence[Line]) -> str:
    """Return how the cases with one effect of the library ended, by effect and strength."""
    singles = [line for line in lines if line["kind"] == "single"]
    rows = []
    for effect in LIBRARY_NAMES:
        cells = []
        for strength in STRENGTHS:
            chosen = [line for line in singles if line["effects"] == [effect] and line["strength"] == strength]
            cells.append(_outcomes(chosen))
        if any(cells):
            rows.append((effect, *cells))
    for strength in OUTCOMES:
        counts = [sum(outcome(x) == strength for x in singles if x["strength"] == one) for one in STRENGTHS]
        rows.append((f"**all: {strength}**", *map(str, counts)))
    return table(("effect", *STRENGTHS), rows)


def _outcomes(lines: Sequence[Line]) -> str:
    found = Counter(outcome(line) + ("" if detectable(line) else " (not detectable)") for line in lines)
    return ", ".join(name if len(lines) == 1 else f"{name} {count}" for name, count in found.most_common())


def confusion_table(lines: Sequence[Line]) -> str:
    """Return what was said about each hidden effect; drivers are left out."""
    rows = []
    for truth in (*LIBRARY_NAMES, *OUTSIDE_NAMES, ""):
        for kind in ("null",) if not truth else ("single", "outside", "taken_out"):
            chosen = [line for line in lines if line["kind"] == kind and line["effects"] == ([truth] if truth else [])]
            if chosen:
                title = (truth or "nothing hidden") + (", taken out" if kind == "taken_out" else "")
                found = Counter(said(line).split(":")[0] for line in chosen)
                told = ", ".join(f"{name} {count}" for name, count in found.most_common())
                rows.append((title, str(len(chosen)), told))
    for line in lines:
        if line["kind"] == "pair":
            rows.append((" + ".join(line["effects"]), "1", said(line)))
    return table(("hidden", "cases", "said"), rows)


def forms_table(lines: Sequence[Line]) -> str:
    """Return how cases ended by the rig's contact, and by the law that a hidden effect of the library follows there."""
    groups: dict[str, list[Line]] = {f"contact: {name}": [] for name in CONTACTS}
    groups |= {f"law of the effect: {which}": [] for which in ("its only one", "the first", "another")}
    laws: dict[str, list[Line]] = {}
    for line in lines:
        groups[f"contact: {line['contact']}"].append(line)
        if line["kind"] == "single":
            [effect] = line["effects"]
            law = line["laws"].get(effect, "")
            which = "its only one" if not law else "the first" if law == next(iter(LAWS[effect])) else "another"
            groups[f"law of the effect: {which}"].append(line)
            if law:
                laws.setdefault(f"{effect}: {law}", []).append(line)
    rows = [(title, *_ended(found)) for title, found in (*groups.items(), *sorted(laws.items())) if found]
    outcomes = ("right", "one of", "outside", "nothing", "wrong")
    return table(("", "nulls: nothing", "library, detectable", *outcomes, "outside, detectable: said"), rows)


def _ended(lines: Sequence[Line]) -> list[str]:
    nulls = [line for line in lines if line["kind"] == "null"]
    library = [line for line in lines if line["kind"] == "single" and detectable(line)]
    outside = [line for line in lines if line["kind"] in ("outside", "taken_out") and detectable(line)]
    ends = Counter("right" if right(line) else outcome(line) for line in library)
    counts = [str(ends[name] or "") for name in ("right", "one of", "outside", "nothing", "wrong")]
    return [_of(nulls), str(len(library)), *counts, _of(outside)]


def _of(lines: Sequence[Line]) -> str:
    return f"{sum(right(line) for line in lines)} of {len(lines)}" if lines else ""


def failures_table(lines: Sequence[Line]) -> str:
    """Return every case whose verdict is not right, with what the diagnosis gave as its reason."""
    rows = []
    for line in lines:
        if right(line, False):
            continue
        answer = line.get("answer")
        chance = f"{answer['p_value']:.3f}" if answer else ""
        reason = str(line.get("behind", {}).get("reason", "")) if answer else str(line["failure"])
        view = f"{visible(line):.1f}" if line["effects"] else ""
        truth = " + ".join(line["effects"]) or "nothing"
        note = " (counts as right with groups)" if right(line) else ""
        kind = f"{line['kind'].replace('_', ' ')} {line['seed']}"
        rows.append((kind, truth, line["strength"], view, said(line) + note, chance, _short(reason)))
    return table(("case", "hidden", "strength", "visible", "said", "p", "reason given"), rows) if rows else "None."


def _short(text: str) -> str:
    plain = " ".join(text.split())
    return plain if len(plain) <= 110 else plain[:107] + "..."


def amplitude_table(lines: Sequence[Line]) -> str:
    """Return the amplitudes that can be compared, with their errors where the effect was named."""
    rows = []
    for effect, entry in AMPLITUDES.items():
        found = [amplitude_of(line, effect) for line in lines if effect in line["effects"] and effect in named(line)]
        told = [one for one in found if one is not None]
        errors = sorted(100 * (ours - true) / abs(true) for true, ours, _ in told)
        middle = f"{sorted(abs(one) for one in errors)[len(errors) // 2]:.3g} %" if errors else ""
        spread = f"{errors[0]:+.0f} to {errors[-1]:+.0f} %" if errors else ""
        judged = [covered for _, _, covered in told if covered is not None]
        held = f"{sum(judged)} of {len(judged)}" if judged else ""
        law = "same" if entry.same else "differs"
        rows.append((effect, f"{entry.text}, {entry.unit}", law, str(len(told)), middle, spread, held))
    headings = (
        "effect",
        "quantity",
        "law",
        "named",
        "median error",
        "errors (ours over truth)",
        "in the 95 % interval",
    )
    left_out = "\n".join(f"* {name}: {why}" for name, why in LEFT_OUT.items())
    return table(headings, rows) + "\n\nLeft out, since no number means the same in both:\n\n" + left_out
