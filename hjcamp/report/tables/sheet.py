"""Arrange an aggregated table for the eye: rows, columns, published values next to them, marks where far off."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Any, Literal

import polars as pl

from hjcamp.report.runs.indicators import CHOICES, FURTHER, INDICATORS
from hjcamp.report.runs.published import CONDITION, MEASURED_WITH, published_cells
from hjcamp.report.tables.aggregation import FAR_OFF, differences
from hjcamp.report.tables.declared import Column, TableDefinition
from hjcamp.report.tables.welch import SIGNIFICANT
from hjcamp.report.wording.units import decimals_of, rounded

TITLES = {
    "rmse1_deg": "RMSE1", "rmse2_deg": "RMSE2", "e_max_deg": "|e|max", "sse_deg": "SSE", "pressure_low_mpa": "lowest, MPa",
    "pressure_high_mpa": "highest, MPa", "below_0p1_s": "below 0.1 MPa, s", "above_0p58_s": "above 0.58 MPa, s",
    "above_range_s": "above the sensors' range, s", "feedforward_share": "share of feedforward",
}  # fmt: skip
FAR_OFF_NOTE = f"▲ ▼: more than {FAR_OFF:g} published standard deviations above or below the published mean."
NO_TEST = "–"
#: Headings of columns that stand beside a mean.
REFERENCE_COLUMNS = ("published", "baseline")
NAMED, REASONS = 3, 6


@dataclass(frozen=True)
class Cell:
    """One cell: its text, what it is, and a mark (▲ above, ▼ below the published value)."""

    text: str
    kind: Literal["key", "value", "published", "block"] = "value"
    mark: str = ""


@dataclass(frozen=True)
class Sheet:
    """A table ready to be written; a row of one ``block`` cell is a heading inside it."""

    name: str
    title: str
    source: str
    headers: list[str]
    rows: list[list[Cell]]
    notes: list[str]


def arrange(table: pl.DataFrame, definition: TableDefinition) -> Sheet:
    """Return a declared table (of `hjcamp.report.tables.aggregation.build_table`) as a sheet."""
    rows = table.to_dicts()
    if definition.across:
        sheet = _arrange_across(rows, definition, _shown_keys(table, definition))
    else:
        sheet = _arrange_plain(rows, definition, _shown_keys(table, definition))
    return sheet


def arrange_conditions(table: pl.DataFrame, notes: Sequence[str] = ()) -> Sheet:
    """Return the frame of `hjcamp.report.tables.aggregation.by_condition` as a sheet: only the choices that vary."""
    names = [name for name in INDICATORS if table[f"{name}_mean"].is_not_null().any()]
    return _of_conditions(
        table,
        "conditions",
        "All conditions",
        names or list(INDICATORS),
        ["Mean ± sample standard deviation over n tests, deg.", *notes],
    )


def arrange_lines(table: pl.DataFrame) -> list[Sheet]:
    """Return the frame of `hjcamp.report.tables.aggregation.lines_by_condition` as a sheet; none where no log holds pressures."""
    names = [name for name in FURTHER if table[f"{name}_mean"].is_not_null().any()]
    note = "Of both lines in the command phase; the share is rms(feedforward) / (rms(feedforward) + rms(feedback))."
    return [_of_conditions(table, "lines", "Line pressure and command", names, [note])] if names else []


def _of_conditions(table: pl.DataFrame, name: str, title: str, indicators: Sequence[str], notes: Sequence[str]) -> Sheet:
    keys = [name for name in CHOICES if table[name].n_unique() > 1]
    if not keys or table.select(keys).is_duplicated().any():
        keys = ["condition", *keys]
    if table.select(keys).is_duplicated().any():
        keys += [name for name in _keys(table) if name not in (*CHOICES, "campaign", "condition")]
    definition = TableDefinition(name=name, title=title, indicators=indicators, by={}, where={}, notes=list(notes))
    return _arrange_plain(table.to_dicts(), definition, keys)


def _shown_keys(table: pl.DataFrame, definition: TableDefinition) -> list[str]:
    across = {group for column in definition.across for group in column.where}
    candidates = [name for name in _keys(table) if name not in across]
    return [name for name in candidates if name in definition.by or table[name].n_unique() > 1]


def _keys(table: pl.DataFrame) -> list[str]:
    # Behind them come the numbers.
    return list(takewhile(lambda name: not name.endswith("_mean"), table.columns))


def _arrange_plain(rows: Sequence[dict[str, Any]], definition: TableDefinition, keys: Sequence[str]) -> Sheet:
    compared = [name for name in definition.indicators if any(row.get(f"{name}_printed") for row in rows)]
    headers = [*keys, "n"]
    for name in definition.indicators:
        headers += [_title(name, definition), *([_reference(rows)] if name in compared else [])]
    body = []
    for row in rows:
        cells = [Cell(str(row[key] or ""), "key") for key in keys]
        cells.append(Cell(str(row["n"])))
        for name in definition.indicators:
            cells += _pair(row, name, definition, name in compared)
        body.append(cells)
    return _sheet(definition, headers, body, rows)


def _arrange_across(rows: Sequence[dict[str, Any]], definition: TableDefinition, keys: Sequence[str]) -> Sheet:
    compared = any(row.get(f"{name}_printed") for row in rows for name in definition.indicators)
    columns = [column for column in definition.across if any(_matches(row, column) for row in rows)]
    headers = list(keys)
    for column in columns:
        headers += [column.title, *([_reference(rows)] if compared else [])]
    headers += [column.title for column in definition.from_print]
    body: list[list[Cell]] = []
    for name in definition.indicators:
        groups: dict[tuple[str, ...], list[dict[str, Any]]] = {}
        for row in rows:
            if row[f"{name}_mean"] is not None:
                groups.setdefault(tuple(str(row[key] or "") for key in keys), []).append(row)
        body += [[Cell(f"{_title(name, definition)}, deg", "block")]] if groups else []
        for values, members in groups.items():
            cells = [Cell(value, "key") for value in values]
            base = _base(members, definition)
            for column in columns:
                member = next((row for row in members if _matches(row, column)), None)
                nothing = [Cell(NO_TEST), *([Cell("", "published")] if compared else [])]
                pair = _pair(member, name, definition, compared) if member else nothing
                cells += [_improved(pair[0], member, base, name), *pair[1:]] if member and base else pair
            for column in definition.from_print:
                cells.append(Cell(_printed(dict(zip(keys, values, strict=True)), column, name, definition), "published"))
            body.append(cells)
    return _sheet(definition, headers, body, rows)


def _base(members: Sequence[dict[str, Any]], definition: TableDefinition) -> dict[str, Any] | None:
    """Return the row that the others are improvements over, None where the table shows no improvement."""
    columns = [column for column in definition.across if column.title == definition.improvement_over]
    return next((row for column in columns for row in members if _matches(row, column)), None)


def _improved(cell: Cell, row: dict[str, Any], base: dict[str, Any], name: str) -> Cell:
    if row is base or not base[f"{name}_mean"]:
        return cell
    percent = 100.0 * (row[f"{name}_mean"] / base[f"{name}_mean"] - 1.0)
    return replace(cell, text=f"{cell.text} ({percent:+.0f} %)")


def _sheet(definition: TableDefinition, headers: list[str], body: list[list[Cell]], rows: Sequence[Mapping[str, Any]]) -> Sheet:
    notes = list(definition.notes)
    if _reference(rows) == "published" and any(cell.mark for row in body for cell in row):
        notes.append(FAR_OFF_NOTE)
    notes += why_no_reference(differences(rows), len(rows))
    return Sheet(definition.name, definition.title, definition.source, headers, body, notes)


def why_no_reference(found: Mapping[str, Sequence[str]], rows: int) -> list[str]:
    """Return a sentence for each reason why no published value stands next to some of the ``rows`` (of `differences`)."""
    notes = []
    for reason, conditions in list(found.items())[:REASONS]:
        more = f" and {len(conditions) - NAMED} more" if len(conditions) > NAMED else ""
        of = "" if len(conditions) == rows else f" {', '.join(conditions[:NAMED])}{more}"
        notes.append(f"No published value is shown next to{of}: {reason}.")
    left = sum(len(conditions) for conditions in list(found.values())[REASONS:])
    return [*notes, f"Nor next to {left} more, for other reasons."] if left else notes


def _title(name: str, definition: TableDefinition) -> str:
    return f"|{TITLES[name]}|" if name in definition.magnitudes else TITLES[name]


def _reference(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return what stands next to the means: the published values, or those of another run."""
    return "baseline" if any(name.endswith("_baseline_mean") for row in rows[:1] for name in row) else "published"


def _pair(row: dict[str, Any], name: str, definition: TableDefinition, compared: bool) -> list[Cell]:
    mean, std = row[f"{name}_mean"], row[f"{name}_std"]
    if mean is not None and name in definition.magnitudes:
        mean = abs(mean)
    text = " ".join(part for part in (with_own_deviation(mean, std), row.get(f"{name}_arrow") or "") if part)
    cells = [Cell(text, "value", far_off(row, name))]
    if compared:
        reference = f"{name}_{_reference([row])}"
        printed = row[f"{reference}_mean"]
        if printed is not None and name in definition.magnitudes:
            printed = abs(printed)
        shown = with_deviation(printed, row[f"{reference}_std"], row[f"{name}_decimals"] or 1)
        cells.append(Cell(shown if row[f"{name}_printed"] else "", "published"))
    return cells


def far_off(row: dict[str, Any], name: str) -> str:
    """Return ▲ or ▼ where a mean is more than two published deviations above or below the published one, else nothing.

    A difference that the rounding of the print could explain is never marked. Next to another run, what is more than
    scatter is marked.
    """
    in_std, difference = row.get(f"{name}_difference_in_std"), row.get(f"{name}_difference")
    if f"{name}_p" in row:
        differs = row[f"{name}_p"] is not None and row[f"{name}_p"] < SIGNIFICANT
        return ("▲" if difference > 0 else "▼") if differs and difference else ""
    if in_std is None or difference is None or abs(in_std) <= FAR_OFF:
        return ""
    if abs(difference) <= 0.5 * 10.0 ** -(row.get(f"{name}_decimals") or 1):
        return ""
    return "▲" if difference > 0 else "▼"


def with_deviation(mean: float | None, std: float | None, decimals: int) -> str:
    """Return "mean ± std" with the decimals of the mean; a dash where there is no mean."""
    if mean is None or math.isnan(mean):
        return NO_TEST
    # A tiny negative number must not show as -0.00.
    shown = f"{round(mean, decimals) + 0.0:.{decimals}f}"
    return shown if std is None else f"{shown} ± {std:.2f}"


def with_own_deviation(mean: float | None, std: float | None) -> str:
    """Return "mean ± std" of a run, rounded to two digits of the deviation; a dash where there is no mean."""
    places = None if std is None else decimals_of(std, mean or 0.0)
    if mean is None or std is None or places is None or math.isnan(mean):
        return with_deviation(mean, std, 2)
    return f"{rounded(mean, places)} ± {rounded(std, places)}"


def _matches(row: dict[str, Any], column: Column) -> bool:
    return all(row.get(group) == name for group, name in column.where.items())


def _printed(keys: dict[str, str], column: Column, name: str, definition: TableDefinition) -> str:
    fixed = {group: names[0] for group, names in definition.where.items() if len(names) == 1}
    wanted = {**MEASURED_WITH, **fixed, **keys, **column.where, "indicator": name}
    cells = published_cells().filter(pl.col("table").is_in(definition.published))
    for group, value in wanted.items():
        cells = cells.filter(pl.col(group) == value) if group in (*CONDITION, "indicator") else cells
    if not cells.height:
        return NO_TEST
    return with_deviation(cells["mean"][0], cells["std"][0], cells["decimals"][0])
