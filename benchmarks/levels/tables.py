"""The tables of levels, from the results of rigs: what they gain and leave, and how far their parameters are off."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from truth.pump_joint.hidden import LIBRARY_NAMES

from benchmarks.hidden_effects.amplitudes import AMPLITUDES, amplitude_of, true_base
from hjcamp.plants.pump_joint.diagnosis.levels import CHANNELS, GAIN
from hjcamp.plants.pump_joint.diagnosis.levels.forms import TABLE as INTERVALS
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import AGAINST
from hjcamp.storage import write_whole

# `gain` is what the best effect gains once it is fitted, as far as it counts; the columns of all effects are what a screening promises.
COLUMNS = (
    "seed", "contact", "tests", "best", "gain", *CHANNELS, "twins_p", "verdict", "effects", "processor_seconds",
    *(f"{GAIN}{name}" for name in LIBRARY_NAMES),
)  # fmt: skip
# `known`: whether the library has the effect; `exact`: whether the law of the one found is (then also what speaks against it).
# `before` and `after`: what the model leaves without and with the first effect found, over what 95 % of its twins leave.
EFFECT_COLUMNS = (
    "seed", "effect", "law", "strength", "contact", "tests", "known", "found", "exact",
    *(f"{when}_{name}" for when in ("before", "after") for name in CHANNELS),
    *AGAINST, "second", "second_gain", "verdict", "effects", "processor_seconds",
)  # fmt: skip
INTERVAL_COLUMNS = ("seed", "effect", "parameter", "error", "deviation", "freedom")


def write_tables(into: Path, lines: Sequence[Mapping[str, Any]], effects: bool) -> None:
    """Write what rigs gain and leave, and beside a table of effects the errors of their parameters; without rigs that failed."""
    lines = [line for line in lines if "failure" not in line]
    if not effects:
        write_table(into, map(row_of, lines), COLUMNS)
        return
    write_table(into, map(effect_row, lines), EFFECT_COLUMNS)
    write_table(into.with_name(INTERVALS.name), (row for line in lines for row in interval_rows(line)), INTERVAL_COLUMNS)


def row_of(line: Mapping[str, Any]) -> dict[str, Any]:
    """Return what one rig with nothing missing gains at most and leaves, over what 95 % of its twins leave."""
    behind, answer = line["behind"], line["answer"]
    step = behind["steps"][0] if behind["steps"] else None
    gain = max(step["counted"], 0.0) if step else 0.0
    promised = step["screened"] if step else {}
    return {
        "seed": line["seed"], "contact": line["contact"], "tests": behind["tests"], "gain": f"{gain:.4g}",
        "best": max(step["weights"], key=step["weights"].get) if step else "",
        **{f"{GAIN}{name}": f"{promised.get(name, 0.0):.3g}" for name in LIBRARY_NAMES},
        **{name: f"{over:.4g}" for name, over in zip(CHANNELS, behind["over"], strict=False)},
        "twins_p": f"{step['p_value'] if step else 1.0:.4g}", "verdict": answer["verdict"],
        "effects": "+".join(answer["effects"]), "processor_seconds": f"{line['processor_seconds']:.1f}",
    }  # fmt: skip


def effect_row(line: Mapping[str, Any]) -> dict[str, Any]:
    """Return what one rig with an effect leaves without and with the first one found, and what a second one gains."""
    behind, answer, (effect,) = line["behind"], line["answer"], line["effects"]
    one = behind["one_effect"]
    nothing = {"effect": "", "before": behind["over"], "after": behind["over"], "second": "", "gain": 0.0, "against": {}}
    one = one or nothing
    return {
        "seed": line["seed"], "effect": effect, "law": line["laws"].get(effect, ""), "strength": line["strength"],
        "contact": line["contact"], "tests": behind["tests"], "known": int(effect in LIBRARY_NAMES),
        "found": one["effect"], "exact": int(one["effect"] in exact_laws()),
        **{
            f"{when}_{name}": f"{over:.4g}"
            for when in ("before", "after")
            for name, over in zip(CHANNELS, one[when], strict=False)
        },
        **{kind: f"{one['against'][kind]:.4g}" if one["against"] else "" for kind in AGAINST},
        "second": one["second"], "second_gain": f"{one['gain']:.4g}", "verdict": answer["verdict"],
        "effects": "+".join(answer["effects"]), "processor_seconds": f"{line['processor_seconds']:.1f}",
    }  # fmt: skip


@cache
def exact_laws() -> frozenset[str]:
    """Return the effects of the library whose law is exact in some driver."""
    from hjcamp.effects import load_effects

    return frozenset(name for name, effect in load_effects([]).items() if effect.exact_in)


def interval_rows(line: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return error and deviation, as shares of the value, of each parameter whose truth is known, where the effect alone was named."""
    answer, (effect,) = line["answer"], line["effects"]
    if answer["verdict"] != "effect" or answer["effects"] != [effect]:
        return []
    # a force that is smooth in speed has no static friction to relieve
    needless = effect == "dither_relief" and line["contact"] == "smooth"
    base, amplitude = true_base(line), None if needless else amplitude_of(line, effect)
    compared = {(effect, AMPLITUDES[effect].single): amplitude[:2]} if amplitude is not None else {}
    found = []
    for of, name, value, deviation, freedom in line["behind"]["deviations"]:
        true, ours = compared.get((of, name), (0.0 if of else base.get(name, 0.0), value))
        if true * ours <= 0.0:
            continue
        error = math.log(ours / true)
        row = {"seed": line["seed"], "effect": of, "parameter": name, "error": f"{error:.4g}"}
        found.append(row | {"deviation": f"{deviation:.4g}", "freedom": freedom})
    return found


def write_table(path: Path, rows: Iterable[Mapping[str, Any]], columns: Sequence[str]) -> None:
    """Write the rows in the order of their seeds."""
    ordered = sorted(rows, key=lambda row: int(row["seed"]))
    text = "".join(",".join(str(row[name]) for name in columns) + "\n" for row in ordered)
    write_whole(path, ",".join(columns) + "\n" + text)
