"""The four numbers that judge a test: RMSE1, RMSE2, largest error and steady state error (thesis 5.2.5)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.records.of_plant import PLANT_KEY
from hjcamp.report.line_indicators import FURTHER, line_indicators
from hjcamp.yaml_file import yaml_values

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.records.log import TestLog

CHOICES = ("trajectory", "controller", "payload", "orientation", "pump", "amplifier", "tubing", "friction")
INDICATORS = ("rmse1_deg", "rmse2_deg", "e_max_deg", "sse_deg")
COLUMNS = ("campaign", *CHOICES, "repetition", *INDICATORS)
#: What tells one test from another, behind the columns that other programs read by place.
IDENTITY = ("condition", "seed", "log")
#: For each published table with cells for the test: the cell's name, and where the test differs from the published one.
STANDING = "_standing"

START_LEFT_OUT = 0.25
SETTLING_TIME = 0.2


def indicators_of(log: TestLog) -> dict[str, Any]:
    r"""Return one row: the contract's columns, and the ``condition`` that the test repeats.

    With the error e = desired - measured arm angle (deg) of the n samples of the command phase (thesis 5.2.5.1 and 2):

    .. math:: RMSE1 = \sqrt{\tfrac{1}{n} \sum e_i^2}, \quad e_{max} = \max |e_i|

    RMSE2 leaves out the first 0.25 s. The steady state error is the mean of e from 0.2 s after the reference last
    changed to the end, for cycloids only; it is negative where the arm is beyond a positive reference, as in Table
    5.4.2 (5.2.5: error = desired - output). What a log cannot give is None.
    """
    row: dict[str, Any] = {"condition": log.condition_key, "campaign": log.metadata.get("campaign")}
    row |= choices_of(log)
    row["repetition"] = _whole_number(log.metadata.get("repetition"))
    row["seed"] = _whole_number(log.metadata.get("seed"))
    row |= error_indicators(log.command_phase, row["trajectory"] or "")
    row |= line_indicators(log, configuration(log.attachments.get("config.yaml", b"")))
    from hjcamp.report.published import cell_key

    # another plant has no such groups: its printed cells are those of a bare, horizontal joint
    bare = {"payload": "none", "orientation": "horizontal"} if log.metadata.get(PLANT_KEY) else {}
    return row | {STANDING: _standing(log.attachments.get("config.yaml", b""), *cell_key(row | bare))}


def error_indicators(command: Mapping[str, Any], trajectory: str) -> dict[str, float | None]:
    """Return the four indicators (deg) from the columns of a command phase; those that cannot be had are None."""
    values: dict[str, float | None] = dict.fromkeys(INDICATORS)
    if not {"reference_deg", "arm_deg"} <= set(command) or not len(command["time_s"]):
        return values
    time, reference = command["time_s"], command["reference_deg"]
    error = reference - command["arm_deg"]
    values["rmse1_deg"] = _root_mean_square(error)
    values["rmse2_deg"] = _root_mean_square(error[time >= START_LEFT_OUT - 1e-9])
    values["e_max_deg"] = float(np.max(np.abs(error)))
    changes = np.flatnonzero(np.diff(reference))
    if trajectory.startswith("cycloid") and changes.size:
        settled = error[time >= time[changes[-1] + 1] + SETTLING_TIME - 1e-9]
        values["sse_deg"] = float(np.mean(settled)) if settled.size else None
    return values


def _root_mean_square(error: NDArray[np.float64]) -> float | None:
    return float(np.sqrt(np.mean(error**2))) if error.size else None


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
    from hjcamp.report.published.configurations import standing

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


def row_of(log: TestLog, folder: Path | None) -> dict[str, Any]:
    """Return the row of `indicators_of` with the place of the log inside ``folder``."""
    return indicators_of(log) | {"log": _place(log.path, folder)}


def frame_with_varied(
    rows: list[dict[str, Any]], attached: Sequence[bytes], axes: Mapping[str, Sequence[str]]
) -> pl.DataFrame:
    """Return rows as a frame, with what varies; ``attached`` is the configuration in the log of each."""
    from hjcamp.report.varied import varied

    for name, values in varied(attached, rows, axes).items():
        for row, value in zip(rows, values, strict=True):
            row[name] = value
    return frame_of(rows)


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
