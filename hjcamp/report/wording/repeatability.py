"""What is said of an error next to its noise floor, whatever the plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

NEAR = 1.3
WORST = ("condition", "channel", "error / noise floor", "shared by repetitions")
NO_NOISE_FLOOR = (
    "No test was repeated, so repeatability is unknown, and so is how much of the error is the model's; "
    "repetitions of the same tests show it (3 of each condition are typical: hjcamp run ... repetitions=3)."
)
WORSE = 1.02


def worst_words(rows: Sequence[Mapping[str, Any]], over: str, most: int = 3) -> list[str]:
    """Return in words which conditions err most, each in its worst channel: ``over`` what, what repetitions share of it, and where
    half of it is in few places.

    ``rows`` are those of an answer (condition, channel, over_floor, shared, unit, at), the worst first.
    """
    from hjcamp.report.wording.channels import channel_label
    from hjcamp.report.wording.units import plain, told

    firsts = {row["condition"]: row for row in reversed(rows)}
    chosen = sorted(firsts.values(), key=lambda row: -row["over_floor"])[:most]
    said = []
    for row in chosen:
        shared = f", {told(row['shared'], row['unit'], 2)} of it shared by repetitions" if row["shared"] else ""
        places = ", ".join(f"{plain(one['time_s'], 4)} s in {one['test']}" for one in row.get("at") or ())
        place = f", half of it about {places}" if places else ""
        said.append(
            f"{row['condition']} {plain(row['over_floor'], 2)} x {over} in {channel_label(row['channel'])}{shared}{place}"
        )
    return [f"{'; '.join(said)}."] if said else []


def worst_table(rows: Sequence[Mapping[str, Any]]) -> tuple[tuple[str, ...], list[list[str]]]:
    """Return the headings and rows of a table of the conditions that err most; what repetitions share where there are any."""
    from hjcamp.report.wording.channels import channel_label
    from hjcamp.report.wording.names import readable
    from hjcamp.report.wording.units import plain, told

    repeated = any(row["shared"] is not None for row in rows)
    columns = [
        [
            readable(row["condition"]),
            channel_label(row["channel"]),
            plain(row["over_floor"], 3),
            *(["" if row["shared"] is None else told(row["shared"], row["unit"])] if repeated else []),
        ]
        for row in rows
    ]
    return WORST if repeated else WORST[:-1], columns


def worse_calibrated(name: str, before: float, after: float, why: str) -> list[str]:
    """Return in words that a model is further off with its base parameters calibrated than as it stands; nothing where it is not.

    ``before`` and ``after`` are its errors over the noise floor (or spread), ``why`` says what the fit looks at.
    """
    if not after > WORSE * before:
        return []
    return [f"Calibrated, {name} is further off than as it stands ({after:.2f} against {before:.2f}): {why}."]
