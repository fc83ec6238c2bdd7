"""What is said of the error that remains: over its repeatability or noise, and against chance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hjcamp.diagnosis.levels import MOST_OF_IT
from hjcamp.report.wording.units import plain, told

if TYPE_CHECKING:
    from hjcamp.diagnosis.decision.verdict import Verdict


def most_remains(content: Mapping[str, Any], verdict: Verdict, source: str) -> list[str]:
    """Say so where less than half of what lies above the noise floor was found in every channel, or one still errs by twice that."""
    from hjcamp.report.wording.channels import channel_label

    rows = content["channels"]
    name = max(rows, key=lambda one: rows[one]["augmented"] / max(rows[one]["floor"], 1e-300))
    row = rows[name]
    kind = "its own noise (third differences)" if source == "sensor" else "the noise floor"
    if any(row["baseline"] - row["augmented"] >= MOST_OF_IT * (row["baseline"] - row["floor"]) for row in rows.values()):
        if row["floor"] >= (1.0 - MOST_OF_IT) * row["augmented"]:
            return []
        # that a law has not quite this form, or what is missing beside it, is said before
        told_why = verdict.law_left > 0.05 and verdict.word != "outside_library"
        errs = (
            f"{channel_label(name)} still errs by {told(row['augmented'], row['unit'])}, "
            f"{plain(row['augmented'] / max(row['floor'], 1e-300), 2)} times {kind}"
        )
        if told_why:
            return [f"{errs}."]
        if source == "repetitions":
            return [
                f"Repetitions share most of the residual, {plain(row['augmented'] / row['floor'], 2)} times the noise floor in "
                f"{channel_label(name)}: the true law has a different shape, or something else is missing as well."
            ]
        return [f"{errs}: the true law has a different shape, something else is missing as well, or the rig scatters."]
    return [
        f"Most of the error remains: {channel_label(name)} errs by {told(row['augmented'], row['unit'])} instead of "
        f"{told(row['baseline'], row['unit'])}, {plain(row['augmented'] / max(row['floor'], 1e-300), 2)} times {kind}. "
        "Something else is missing as well, or the rig scatters."
    ]


def over_noise(content: Mapping[str, Any], source: str) -> list[str]:
    """Say which sensor errs by twice its noise where near-replicates differ by that: what acts otherwise in them makes that, too."""
    from hjcamp.report.wording.channels import channel_label

    rows, errs = content["floor"], {name: row["augmented"] for name, row in content["channels"].items()}
    name = max(rows, key=lambda one: errs[one] / rows[one]["low"])
    if source != "near_replicates" or errs[name] * (1.0 - MOST_OF_IT) <= rows[name]["low"]:
        return []
    return [
        f"{channel_label(name)} errs by {told(errs[name], rows[name]['unit'])}, {plain(errs[name] / rows[name]['low'], 2)} times its "
        f"own noise (third differences). Near-replicates differ by {told(rows[name]['value'], rows[name]['unit'])}: that is "
        "scatter of the rig, or something that no log contains. A repeated test would show which."
    ]


def remains(name: str, row: Mapping[str, Any], p: float) -> str:
    """What a channel still errs by, beyond chance, and what may be the reason."""
    chance = (
        f"and more than chance (p = {plain(p, 2)}): something may be missing that neither the library nor a non-parametric term "
        "describes."
        if p <= 0.05
        else f"though the library explains no more of it than chance (p = {plain(p, 2)})."
    )
    scatter = (
        "Repetitions share it in few windows alone."
        if row["source"] == "repetitions"
        else "A repeated test would show whether it is scatter of the rig."
    )
    return f"{still_errs(name, row)}, {chance} {scatter}"


def still_errs(name: str, row: Mapping[str, Any]) -> str:
    """What a channel still errs by, and how many times its noise floor or noise that is."""
    from hjcamp.report.wording.channels import channel_label

    over = "own noise (third differences)" if row["value"] is None else "noise floor"
    times = f"{plain(row['high'] / least(row), 2)} times its {over}"
    return f"{channel_label(name)} still errs by {told(row['high'], row['unit'])}, {times}"


def least(row: Mapping[str, Any]) -> float:
    """Return the noise floor of a channel, or its noise where none is known."""
    return float(row["low"] if row["value"] is None else row["value"])
