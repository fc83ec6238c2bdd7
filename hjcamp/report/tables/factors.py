"""What the axes of a campaign do to the indicators: the effect of each value against the first, with its interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import polars as pl

from hjcamp.report.runs.indicators import INDICATORS
from hjcamp.report.runs.origin import RunOrigin
from hjcamp.report.runs.varied import SEPARATOR, labels_of
from hjcamp.report.tables.sheet import TITLES, Cell, Sheet, with_own_deviation
from hjcamp.report.tables.welch import SIGNIFICANT, Sample, contrast, holm

ALL = "mean of all"
MOST_ROWS = 16
COLUMNS: dict[str, Any] = {
    "axis": pl.String, "value": pl.String, "against": pl.String, "on": pl.String, "indicator": pl.String,
    "difference": pl.Float64, "half_interval_95": pl.Float64, "p": pl.Float64, "p_holm": pl.Float64,
}  # fmt: skip


@dataclass(frozen=True)
class Factor:
    """One axis of a campaign: its values, and the condition of each value in each combination of the other axes."""

    name: str
    values: Sequence[str]
    conditions: Mapping[str, Mapping[str, str]]

    def pairs(self, value: str, known: Mapping[str, Sample]) -> dict[str, tuple[Sample, Sample]]:
        """Return the samples of ``value`` and of the first value in each combination where both are known."""
        first = self.values[0]
        return {
            on: (known[by[value]], known[by[first]])
            for on, by in self.conditions.items()
            if by.get(value) in known and by.get(first) in known
        }


def factors_of(origin: RunOrigin) -> list[Factor]:
    """Return the axes of a run that leave what is asked of the plant as it is: errors of other motions are no effect."""
    axes = {name: labels for name, labels in origin.axes.items() if labels}
    conditions = {str(one["name"]): one.get("config") or {} for one in origin.plan.get("conditions") or ()}
    labelled = {name: labels_of(name, axes) for name in conditions}
    found = []
    for axis, labels in axes.items():
        by: dict[str, dict[str, str]] = {}
        for name, given in labelled.items():
            if given:
                by.setdefault(SEPARATOR.join(given[one] for one in axes if one != axis), {})[given[axis]] = name
        asked = [{str(conditions[name].get("trajectory")) for name in one.values()} for one in by.values()]
        if len(labels) > 1 and asked and all(len(one) == 1 for one in asked):
            found.append(Factor(axis, labels, by))
    return found


def samples_of(indicators: pl.DataFrame, indicator: str) -> dict[str, Sample]:
    """Return mean, deviation and number of tests of an indicator by condition."""
    values = indicators.drop_nulls(indicator).group_by("condition", maintain_order=True)
    rows = values.agg(pl.col(indicator).mean().alias("mean"), pl.col(indicator).std().alias("std"), pl.len().alias("n"))
    return {row["condition"]: Sample(row["mean"], row["std"], row["n"]) for row in rows.iter_rows(named=True)}


def effects_of(factors: Sequence[Factor], indicators: pl.DataFrame) -> pl.DataFrame:
    """Return one row for each value, combination of the other axes and indicator, and one for their mean (`COLUMNS`).

    ``p_holm`` is corrected for the number of rows. Without repetitions there are no rows: nothing could be told.
    """
    rows: list[Any] = []
    samples = {name: samples_of(indicators, name) for name in INDICATORS}
    for factor in factors:
        for value in factor.values[1:]:
            for name, known in samples.items():
                pairs = factor.pairs(value, known)
                groups = {on: [pair] for on, pair in pairs.items()}
                groups |= {ALL: list(pairs.values())} if len(pairs) > 1 else {}
                for on, members in groups.items():
                    difference, half, p = contrast(*map(list, zip(*members, strict=True)))
                    if half is not None:
                        rows.append([factor.name, value, factor.values[0], on, name, difference, half, p])
    corrected = holm([row[-1] for row in rows])
    return pl.DataFrame([[*row, p] for row, p in zip(rows, corrected, strict=True)], schema=COLUMNS, orient="row")


def effects_sheet(effects: pl.DataFrame, most_rows: int | None = None) -> Sheet | None:
    """Return the effects as a sheet, None where there are none; with ``most_rows`` the means alone where there are more."""
    if not effects.height:
        return None
    keys = ["axis", "value", "against", "on"]
    lines = effects.select(keys).unique(maintain_order=True)
    notes = [
        f"Difference ± half its 95 % interval (Welch), deg. ▲ ▼: p < {SIGNIFICANT:g} after Holm's correction for "
        f"{effects.height} tests; without a mark these tests cannot tell."
    ]
    if most_rows is not None and lines.height > most_rows and (lines["on"] == ALL).any():
        notes.append(f"The {lines.filter(pl.col('on') != ALL).height} single effects are in tables/effects.csv.")
        lines = lines.filter(pl.col("on") == ALL)
    names = [name for name in INDICATORS if (effects["indicator"] == name).any()]
    cells = {tuple(row[key] for key in (*keys, "indicator")): row for row in effects.iter_rows(named=True)}
    body = []
    for line in lines.iter_rows():
        _, value, against, on = line
        shown = [_cell(cells.get((*line, name))) for name in names]
        body.append([Cell(f"{value} against {against}", "key"), Cell(on, "key"), *shown])
    several = any(row[1].text for row in body)
    rows = body if several else [[row[0], *row[2:]] for row in body]
    headers = ["effect", *(["on"] if several else []), *(TITLES[name] for name in names)]
    return Sheet("effects", "Effects of what varies", "", headers, rows, notes)


def _cell(row: Mapping[str, Any] | None) -> Cell:
    if row is None:
        return Cell("–")
    difference, half = row["difference"], row["half_interval_95"]
    mark = "" if row["p_holm"] >= SIGNIFICANT else "▲" if difference > 0 else "▼"
    return Cell(("+" if difference > 0 else "") + with_own_deviation(difference, half), mark=mark)
