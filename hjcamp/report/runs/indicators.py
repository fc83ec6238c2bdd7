"""The numbers that judge a test, one row for each log: what they are says the plant."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError
from hjcamp.known_plants import usual_plant
from hjcamp.records.of_plant import PLANT_KEY
from hjcamp.yaml_file import yaml_values

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.records.log import TestLog

_USUAL = usual_plant()
CHOICES = ("trajectory", "controller", *_USUAL.setups, *_USUAL.rig, "friction")
_ROOM = _USUAL.own_room("indicators")
INDICATORS: tuple[str, ...] = _ROOM.INDICATORS
FURTHER: tuple[str, ...] = _ROOM.FURTHER
error_indicators, line_indicators = _ROOM.error_indicators, _ROOM.line_indicators
COLUMNS = ("campaign", *CHOICES, "repetition", *INDICATORS)
#: What tells one test from another, behind the columns that other programs read by place.
IDENTITY = ("condition", "seed", "log")
#: For each published table with cells for the test: the cell's name, and where the test differs from the published one.
STANDING = "_standing"


def indicators_of(log: TestLog) -> dict[str, Any]:
    """Return one row: the contract's columns, and the ``condition`` that the test repeats; what a log cannot give is None."""
    row: dict[str, Any] = {"condition": log.condition_key, "campaign": log.metadata.get("campaign")}
    row |= choices_of(log)
    row["repetition"] = _whole_number(log.metadata.get("repetition"))
    row["seed"] = _whole_number(log.metadata.get("seed"))
    row |= error_indicators(log.command_phase, row["trajectory"] or "")
    row |= line_indicators(log, configuration(log.attachments.get("config.yaml", b"")))
    from hjcamp.report.runs.published import cell_key

    # another plant has no such groups: its printed cells are those of a bare, horizontal joint
    bare = {"payload": "none", "orientation": "horizontal"} if log.metadata.get(PLANT_KEY) else {}
    return row | {STANDING: _standing(log.attachments.get("config.yaml", b""), *cell_key(row | bare))}


def choices_of(log: TestLog) -> dict[str, str | None]:
    """Return the choice of each group: from the metadata, else from the attached configuration, else None."""
    missing = [group for group in CHOICES if group not in log.metadata]
    attached = configuration(log.attachments.get("config.yaml", b"")) if missing else {}
    return {group: log.metadata.get(group) or _named(attached.get(group)) for group in CHOICES}


def _named(group: object) -> str | None:
    name = group.get("name") if isinstance(group, dict) else group
    return str(name) if name is not None else None


@lru_cache(maxsize=1024)
def _standing(attachment: bytes, *cell: str) -> list[dict[str, str]]:
    from hjcamp.report.runs.published import standing

    return standing(configuration(attachment), cell)


@lru_cache(maxsize=1024)
def configuration(attachment: bytes) -> dict[str, Any]:
    """Return the attached configuration; a damaged one counts as absent, because the samples are still good."""
    try:
        config = yaml_values(attachment)
    except UsageError:
        return {}
    return config if isinstance(config, dict) else {}


def _whole_number(text: str | None) -> int | None:
    try:
        return int(text) if text is not None else None
    except ValueError:
        return None


def row_of(log: TestLog, folder: Path | None) -> dict[str, Any]:
    """Return the row of `indicators_of` with the place of the log inside ``folder``."""
    return indicators_of(log) | {"log": _place(log.path, folder)}


def _place(path: Path | None, folder: Path | None) -> str | None:
    if path is None:
        return None
    inside = folder is not None and path.resolve().is_relative_to(folder.resolve())
    return (path.resolve().relative_to(folder.resolve()) if inside and folder else path).as_posix()


def varied_columns(frame: pl.DataFrame) -> list[str]:
    """Return the columns of an indicators frame that hold what varies beyond the choices."""
    return [name for name in frame.columns if name not in (*COLUMNS, *IDENTITY, *FURTHER, STANDING)]


def frame_of(rows: Iterable[dict[str, Any]]) -> pl.DataFrame:
    """Return rows of `indicators_of` as a frame with fixed types, also where there are none."""
    import polars as pl

    schema: dict[str, Any] = {"condition": pl.String, "campaign": pl.String} | dict.fromkeys(CHOICES, pl.String)
    schema |= {"repetition": pl.Int64} | dict.fromkeys(INDICATORS, pl.Float64) | {"seed": pl.Int64, "log": pl.String}
    schema |= dict.fromkeys(FURTHER, pl.Float64)
    rows = list(rows)
    further = [name for name in (rows[0] if rows else ()) if name not in (*schema, STANDING)]
    schema[STANDING] = pl.List(pl.Struct(dict.fromkeys(("table", "cell", "differs"), pl.String)))
    frame = pl.DataFrame([{name: row.get(name) for name in schema} for row in rows], schema=schema)
    return frame.with_columns(pl.Series(name, [row[name] for row in rows]) for name in further)
