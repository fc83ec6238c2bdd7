"""What was varied: the parameters and axes that tell the conditions of some logs apart, beyond their choices."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.report.runs.indicators import CHOICES, COLUMNS, IDENTITY, configuration, frame_of, row_of
from hjcamp.report.runs.settings import leaves

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.records.log import TestLog

#: What belongs to the run, or follows from a parameter of another name.
LEFT_OUT = ("repetitions", "seed", "controller_model")
SEPARATOR = "__"


def varied(
    attached: Sequence[bytes], rows: Sequence[Mapping[str, Any]], axes: Mapping[str, Sequence[str]]
) -> dict[str, list[Any]]:
    """Return one column for each axis and each parameter that varies, a value per log with its attached configuration.

    An axis of one parameter holds its values under the parameter's full name, any other its labels under its own name.
    A parameter that differs only because a choice does (that of its group, or all choices together) is left out.
    """
    flat = {text: dict(leaves(configuration(text), "")) for text in dict.fromkeys(attached)}
    labels = [labels_of(str(row["condition"]), axes) for row in rows]
    # Repetitions say nothing new: one of each condition decides whether a parameter varies.
    choices = [tuple(row[group] for group in CHOICES) for row in rows]
    distinct = [(flat[text], chosen) for text, chosen in dict.fromkeys(zip(attached, choices, strict=True))]
    columns: dict[str, list[Any]] = {}
    for axis in axes:
        if axis in CHOICES:
            continue
        if "." in axis and any(axis in known for known in flat.values()):
            columns[axis] = [flat[text].get(axis) for text in attached]
        else:
            name = f"axis_{axis}" if axis in (*COLUMNS, *IDENTITY) else axis
            columns[name] = [found.get(axis) for found in labels]
    for key in dict.fromkeys(key for known in flat.values() for key in known):
        known_otherwise = key.split(".")[0] in LEFT_OUT or key.endswith(".name") or key in columns
        if not known_otherwise and _varies(key, distinct):
            columns[key] = [flat[text].get(key) for text in attached]
    return {name: _one_type(values) for name, values in columns.items() if any(value is not None for value in values)}


def labels_of(condition: str, axes: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return the label of each axis in the name of a condition; empty where the name is not made of them."""
    names = list(axes)

    def matched(rest: str, place: int) -> list[str] | None:
        if place == len(names):
            return [] if not rest else None
        for label in axes[names[place]]:
            last = place == len(names) - 1
            if rest == label if last else rest.startswith(label + SEPARATOR):
                found = matched("" if last else rest[len(label) + len(SEPARATOR) :], place + 1)
                if found is not None:
                    return [label, *found]
        return None

    return dict(zip(names, matched(condition, 0) or [], strict=False))


def _varies(key: str, distinct: Sequence[tuple[Mapping[str, Any], tuple[str | None, ...]]]) -> bool:
    name = f"{key.split('.')[0]}.name"
    seen: dict[Any, str] = {}
    for known, choices in distinct:
        text = _text(known.get(key))
        if known and seen.setdefault(known.get(name, choices), text) != text:
            return True
    return False


def _one_type(values: Sequence[Any]) -> list[Any]:
    there = [value for value in values if value is not None]
    if all(isinstance(value, bool) for value in there):
        return list(values)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in there):
        return [None if value is None else float(value) for value in values]
    return [None if value is None else value if isinstance(value, str) else _text(value) for value in values]


def _text(value: Any) -> str:
    return json.dumps(value, default=str)


def indicators_frame(
    logs: Iterable[TestLog], axes: Mapping[str, Sequence[str]] | None = None, folder: Path | None = None
) -> pl.DataFrame:
    """Return one row per log, in the order of the logs.

    Columns: ``condition``, the contract's, ``seed``, ``log`` (its path inside ``folder``), and each parameter and axis
    that varies from condition to condition under its full name; ``axes`` are those of the plan, with their labels.
    """
    rows, attached = [], []
    for log in logs:
        rows.append(row_of(log, folder))
        attached.append(log.attachments.get("config.yaml", b""))
    return frame_with_varied(rows, attached, axes or {})


def frame_with_varied(rows: list[dict[str, Any]], attached: Sequence[bytes], axes: Mapping[str, Sequence[str]]) -> pl.DataFrame:
    """Return rows as a frame, with what varies; ``attached`` is the configuration in the log of each."""
    for name, values in varied(attached, rows, axes).items():
        for row, value in zip(rows, values, strict=True):
            row[name] = value
    return frame_of(rows)
