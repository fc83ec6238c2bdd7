"""What is said of values at bounds: of base parameters, of effects, of input delays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.diagnosis.calibration.shares import left_of
from hjcamp.model.declare.base_values import DELAY
from hjcamp.report.wording.units import plain, told


def held_by_bounds(rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return a sentence for each base parameter at a bound that is far from what is declared, or of which the tests tell nothing."""
    from hjcamp.diagnosis.estimation.intervals import limited

    found = []
    for name, row in rows.items():
        said, value = name.replace("_", " "), told(row["value"], row["unit"])
        if row.get("held"):
            found.append(
                f"{said} is held by its bound, {value}, far from what is declared: is a sign or a unit wrong in the plant's file or in "
                "the import map? It may absorb the missing effect."
            )
        elif limited(row) and not row.get("told", True) and not name.startswith(DELAY):
            found.append(
                f"{said} stands at its bound, {value}, and these tests do not determine it: do they not excite it, or is a "
                "sign or a unit wrong?"
            )
    return found


def other_sizes(rows: Mapping[str, Mapping[str, Any]], candidates: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return in words which effects stand at bounds that follow from what the plant declares, where its base is far from that."""
    from hjcamp.diagnosis.estimation.intervals import limited

    near = [one for one in candidates if left_of(one) < 1.0]
    # a share has the same bounds on every plant
    held = [one["effect"] for one in near if any(limited(row) for row in one["parameters"].values() if row["unit"] != "1")]
    told_here = {name: row for name, row in rows.items() if row["published"] and row.get("told", True) and not row["at_bound"]}
    moved = {name: abs(row["value"] / row["published"]) for name, row in told_here.items()}
    far = [
        f"{name.replace('_', ' ')} is {plain(ratio, 2)} times as large"
        for name, ratio in moved.items()
        if not 0.5 <= ratio <= 2.0
    ]
    if not held or not far:
        return []
    return [
        f"The bounds of effects follow from the plant's file, and here {', '.join(far)}: {', '.join(held)} may stand at a bound for "
        "that reason. Write the values that the table has into the file, and ask again."
    ]


def ends_of_laws(named: Sequence[str], candidates: Sequence[Mapping[str, Any]], library: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each shape of a named law that the tests want farther than the law may have it."""
    return [
        f"{parameter.replace('_', ' ')} of {one['effect']} stands at the end of what this law may have, "
        f"{told(row['value'], row['unit'])}: another law of the same place may be what is missing."
        for one in candidates
        if one["effect"] in named
        for parameter, row in one["parameters"].items()
        if row["at_bound"] and row.get("told", True) and library[one["effect"]].parameters[parameter].shape
    ]


def late_inputs(rows: Mapping[str, Mapping[str, Any]], named: Sequence[str], period: float) -> list[str]:
    """Return what delays of the base say that stand at their bound, or are longer than a log may be off: one sample of ``period``."""
    late = {
        name.removeprefix(DELAY).replace("_", " "): row
        for name, row in rows.items()
        if name.startswith(DELAY) and row["value"] > 0.0
    }
    most = [name for name, row in late.items() if row["at_bound"]]
    longer = [name for name, row in late.items() if (row["ci95"][0] or 0.0) > period]
    if {"command_delay", "action_lag", "sensor_lag"} & {name.split("_at_")[0] for name in named}:
        own = [f"{name} by {plain(late[name]['value'], 3)} s" for name in dict.fromkeys(most + longer)]
        return [f"Input delays were also fitted ({', '.join(own)}): the total lag is the sum."] if own else []
    if most:
        return [
            f"The delay of {' and '.join(most)} stands at the most that the base may have, {plain(late[most[0]]['value'], 3)} s: a "
            "longer one, or a lag, is an effect (command_delay, sensor_lag)."
        ]
    return [
        f"The {name} acts {plain(late[name]['value'], 3)} s late, more than the one sample by which a log may be off: the base "
        "absorbs so short a delay, and the cause may be another (command_delay, sensor_lag, second_store)."
        for name in longer
    ]
