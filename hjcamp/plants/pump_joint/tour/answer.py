"""The end of the tour: what hides in the recordings, and what the diagnosis said."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import counted
from hjcamp.plants.pump_joint.tour.samples import SEALED, sealed_answer
from hjcamp.report.wording.units import estimate_texts, number_like, told_interval

if TYPE_CHECKING:
    from rich.console import Console

VERDICTS = {
    "nothing_missing": "nothing is missing",
    "one_of": "one of",
    "outside_library": "something outside the library",
    "cannot_tell": "these tests cannot tell",
}


def print_answer(console: Console, diagnosis: dict[str, Any] | None, sealed: Path = SEALED, tour: str = "hjcamp tour") -> None:
    """Print the sealed answer; ``diagnosis`` is the answer of the step that diagnoses, None where it has not been done."""
    from rich.table import Table

    hidden = sealed_answer(sealed)
    console.print(f"hidden      {', '.join(hidden['effects'])}", style="bold", markup=False)
    if diagnosis is None:
        console.print(f"diagnosed   nothing yet: {tour}", markup=False)
    else:
        console.print(f"diagnosed   {said(diagnosis)}   {judged(hidden, diagnosis)}", style="bold", markup=False)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("", "published", "hidden", "found", "95 %", ""):
        table.add_column(heading, justify="left" if not heading else "right")
    for cells in rows(hidden, diagnosis or {}):
        table.add_row(*cells)
    console.print(table)
    for text in (hidden["note"], compared(hidden, diagnosis or {})):
        for line in textwrap.wrap(text, min(console.width, 100)):
            console.print(line, markup=False)
    console.print(f"made by     {hidden['made_by']}", markup=False)


def said(diagnosis: dict[str, Any]) -> str:
    """Return the verdict in words."""
    names = ", ".join(diagnosis["effects"])
    verdict = str(diagnosis["verdict"])
    return names if verdict == "effect" else f"{VERDICTS.get(verdict, verdict)} {names}".rstrip()


def judged(hidden: dict[str, Any], diagnosis: dict[str, Any]) -> str:
    """Return whether the diagnosis is right."""
    same = sorted(diagnosis["effects"]) == sorted(hidden["effects"])
    if diagnosis["verdict"] == hidden["verdict"] and same:
        return "right"
    if set(hidden["effects"]) & set(diagnosis["effects"]):
        return "partly right"
    return "not what was hidden"


def rows(hidden: dict[str, Any], diagnosis: dict[str, Any]) -> list[tuple[str, ...]]:
    """Return the cells of the table: name, published, hidden, found, interval, unit."""
    return [
        _cells(name, "none" if row is None or row.get("published") is None else number_like(row["published"], row), value, row)
        for name, value, row in _pairs(hidden, diagnosis)
    ]


def compared(hidden: dict[str, Any], diagnosis: dict[str, Any]) -> str:
    """Return in words how what was found compares with what was hidden: inside the intervals, and by how much where outside."""
    pairs = [(name, value, row) for name, value, row in _pairs(hidden, diagnosis) if row is not None]
    outside = [
        f"{name.replace('_', ' ')} (found {abs(row['value'] / value - 1.0) * 100:.0f} % "
        f"{'higher' if row['value'] > value else 'lower'})"
        for name, value, row in pairs
        if not row["ci95"][0] <= value <= row["ci95"][1]
    ]
    if not pairs:
        return ""
    inside = (
        f"{len(pairs) - len(outside)} of {counted(len(pairs), 'hidden value')} lie within the 95 % interval of what was found"
    )
    return f"{inside}; outside: {', '.join(outside)}." if outside else f"{inside}."


def _pairs(hidden: dict[str, Any], diagnosis: dict[str, Any]) -> list[tuple[str, float, dict[str, Any] | None]]:
    """Return name, hidden value and what was found of it (None: nothing) of every parameter."""
    candidates = {row["effect"]: row["parameters"] for row in diagnosis.get("candidates") or []}
    calibration = diagnosis.get("calibration_with_effects") or diagnosis.get("calibration") or {}
    return [
        (f"{effect}.{name}", value, candidates.get(effect, {}).get(name))
        for effect, parameters in hidden["parameters"].items()
        for name, value in parameters.items()
    ] + [(name, value, calibration.get(name)) for name, value in hidden["base"].items()]


def _cells(name: str, published: str, value: float, row: dict[str, Any] | None) -> tuple[str, ...]:
    if row is None:
        return name, published, f"{value:.3g}", "", "", ""
    found, _, unit = estimate_texts(row)
    return name, published, number_like(value, row), found, told_interval(row), unit
