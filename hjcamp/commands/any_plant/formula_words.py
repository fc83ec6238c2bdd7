"""What a diagnosis says of the formula that a found curve is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hjcamp.diagnosis.calibration.shares import left_of, share_of
from hjcamp.effects._forms import FORMS
from hjcamp.report.wording.units import plain, told, told_error


def formula_words(formulas: Mapping[str, Any], law: str, driver: str, source: str = "") -> list[str]:
    """Say which formula a missing ``law`` is over its ``driver``, what it takes, which others fit, or that none does.

    What it takes is said where ``source`` says what errors are measured by.
    """
    if not formulas:
        return []
    first, *others = formulas["forms"]
    if formulas["none"]:
        chance = f"p = {plain(formulas['p_value'], 2)}, level {formulas['level']:g}"
        return [
            f"None of {formulas['compared']} formulas of at most three parameters fits the curve of the missing {law}: the nearest, "
            f"{first['words']}, leaves more than the errors of its knots explain ({chance})."
        ]
    takes = ""
    if source:
        takes = f"; it takes {100.0 * (1.0 - left_of(first)):.0f} % of {share_of(first, source)} on held-out blocks"
    rest = "; ".join(f"{one['words']}, {_formula(one)}" for one in others)
    also = f" Not ruled out: {rest}." if others else ""
    return [f"The missing {law} is {first['words']}: {_formula(first)} (95 %), x being {driver}{takes}.{also}"]


def _formula(row: Mapping[str, Any]) -> str:
    values = [
        f"{name} = {told_error(one['value'], 0.5 * (one['ci95'][1] - one['ci95'][0]), one['unit'])}"
        for name, one in row["parameters"].items()
    ]
    if "reference" in row:
        values.append(f"r = {told(row['reference'], row['x_unit'])}")
    return f"{FORMS[row['form']].said} with {', '.join(values)}"
