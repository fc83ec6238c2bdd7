"""Aggregate indicators into the declared tables, and set them next to the published values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any, Protocol

import polars as pl

from hjcamp.report.runs.indicators import CHOICES, FURTHER, INDICATORS, STANDING, varied_columns
from hjcamp.report.runs.published import CAMPAIGNS, CONDITION, MEASURED_WITH, cell_key, published_cells
from hjcamp.report.tables.declared import TableDefinition

#: From how many published deviations on a difference is marked.
FAR_OFF = 2.0
REFERENCE_COLUMNS = {
    "_published_mean": pl.Float64,
    "_published_std": pl.Float64,
    "_decimals": pl.Int64,
    "_printed": pl.Boolean,
}


class AnotherRun(Protocol):
    """A run to compare with, as `RunComparison` is."""

    def with_reference(self, table: pl.DataFrame, names: Sequence[str], magnitudes: Sequence[str] = ()) -> pl.DataFrame:
        """Return an aggregated table with the values of that run in columns of their own."""


def aggregate(indicators: pl.DataFrame, keys: Sequence[str], names: Sequence[str] = INDICATORS) -> pl.DataFrame:
    """Return ``<indicator>_mean``, ``<indicator>_std`` (sample) and ``n`` for each group of equal ``keys``.

    Choices that vary beyond the keys become keys as well, so that different conditions are never averaged, and so does
    what was varied where two runs give their conditions equal names. The order is that of first appearance.
    """
    frame = _with_defaults(indicators)
    spare = [group for group in CHOICES if group not in keys and frame[group].n_unique() > 1]
    keys = [*keys, *spare]
    for name in ("condition", *varied_columns(frame)):
        if name not in keys and frame.height:
            per_group = frame.group_by(keys).agg(pl.col(name).n_unique())[name].max()
            keys = [*keys, name] if isinstance(per_group, int) and per_group > 1 else keys
    kept = [pl.col(STANDING).first()]
    kept += [] if "condition" in keys else [pl.col("condition").first().alias("_condition")]
    numbers = [pl.col(name).mean().alias(f"{name}_mean") for name in names]
    numbers += [pl.col(name).std().alias(f"{name}_std") for name in names]
    ordered = [expression for pair in zip(numbers[: len(names)], numbers[len(names) :], strict=True) for expression in pair]
    count = pl.len().cast(pl.Int64).alias("n")
    return frame.group_by(keys, maintain_order=True).agg(*ordered, count, *kept)


def build_table(indicators: pl.DataFrame, definition: TableDefinition, against: str | AnotherRun | None = None) -> pl.DataFrame:
    """Return the aggregated frame of one declared table: its choices, ``<indicator>_mean``, ``_std``, ``n``.

    With arrows declared, ``<indicator>_arrow`` is ↓, ↑ or =. With ``against="published"`` each indicator has
    ``_published_mean``, ``_published_std``, ``_difference`` and ``_difference_in_std`` next to it (null where the thesis
    prints nothing), but only in rows whose configuration is that of the published test; ``published_differs`` says
    where another row's is not. With another run, its values stand next to it as `RunComparison.with_reference` has them. Rows without
    tests are left out; no rows at all is an empty frame.
    """
    frame = _with_defaults(indicators)
    for group, names in definition.where.items():
        frame = frame.filter(pl.col(group).is_in(names))
    for group, names in definition.by.items():
        frame = frame.filter(pl.col(group).is_in(names)) if names else frame
    if definition.across:
        matches = [pl.all_horizontal(pl.col(group) == name for group, name in c.where.items()) for c in definition.across]
        frame = frame.filter(pl.any_horizontal(matches))
    table = aggregate(frame, definition.keys, definition.indicators)
    table = table.filter(pl.any_horizontal(pl.col(f"{name}_mean").is_not_null() for name in definition.indicators))
    positions = [_position(group, names) for group, names in definition.by.items() if names]
    table = table.sort(positions, maintain_order=True) if positions else table
    if definition.arrows:
        table = _with_arrows(table, definition)
    if against == "published":
        for group, names in definition.where.items():
            fixed = group not in table.columns and group in CONDITION and len(names) == 1
            table = table.with_columns(pl.lit(names[0]).alias(group)) if fixed else table
        return _with_published(table, definition.published, definition.indicators, definition.magnitudes)
    if against is not None and not isinstance(against, str):
        table = against.with_reference(table, definition.indicators, definition.magnitudes)
    return table.drop(pl.selectors.starts_with("_"))


def by_condition(indicators: pl.DataFrame, against: str | AnotherRun | None = "published") -> pl.DataFrame:
    """Return one row per condition with means, deviations and n, and the published values or another run's next to them."""
    table = aggregate(indicators, ["condition", "campaign", *CHOICES])
    if isinstance(against, str):
        return _with_published(table, list(CAMPAIGNS), INDICATORS)
    table = table.drop(pl.selectors.starts_with("_"))
    return table if against is None else against.with_reference(table, INDICATORS)


def lines_by_condition(indicators: pl.DataFrame) -> pl.DataFrame:
    """Return one row per condition with means and deviations of the indicators of lines and command."""
    table = aggregate(indicators, ["condition", "campaign", *CHOICES], FURTHER)
    return table.drop(pl.selectors.starts_with("_"))


def differences(rows: Iterable[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Return why no published value stands next to it (``published_differs``), each reason with its conditions."""
    found: dict[str, list[str]] = {}
    for row in rows:
        if row.get("published_differs"):
            name = str(row.get("condition") or row.get("_condition") or "")
            found.setdefault(row["published_differs"], []).append(name)
    return found


def against_published(indicators: pl.DataFrame, definitions: Sequence[TableDefinition]) -> pl.DataFrame:
    """Return every published cell that the tests cover, one row each.

    Columns: table, condition, the choices, indicator, mean, std, n, published_mean, published_std, difference,
    difference_in_std (null where the thesis prints no deviation).
    """
    parts = []
    for definition in definitions:
        table = build_table(indicators, definition, "published")
        named = pl.col("condition" if "condition" in table.columns else "_condition").alias("condition")
        for name in definition.indicators:
            columns = [pl.col(group) for group in CHOICES if group in table.columns]
            values = ("mean", "std", "published_mean", "published_std", "difference", "difference_in_std")
            part = table.select(
                pl.lit(definition.name).alias("table"),
                named,
                *columns,
                pl.lit(name).alias("indicator"),
                "n",
                *[pl.col(f"{name}_{value}").alias(value) for value in values],
            )
            parts.append(part.filter(pl.col("published_mean").is_not_null()))
    return pl.concat(parts, how="diagonal") if parts else pl.DataFrame()


def _with_defaults(indicators: pl.DataFrame) -> pl.DataFrame:
    return indicators.with_columns(pl.col(group).fill_null(name) for group, name in MEASURED_WITH.items())


def _position(group: str, names: Sequence[str]) -> pl.Expr:
    places = list(range(len(names)))
    return pl.col(group).replace_strict(list(names), places, default=len(names), return_dtype=pl.Int64)


def _with_arrows(table: pl.DataFrame, definition: TableDefinition) -> pl.DataFrame:
    arrows = definition.arrows
    assert arrows is not None
    keys = [name for name in table.columns if name in (*CHOICES, "condition") and name not in (arrows.group, "condition")]
    for name in arrows.indicators:
        other = table.filter(pl.col(arrows.group) == arrows.against)
        other = other.select(*keys, pl.col(f"{name}_mean").alias("_other")).unique(keys, keep="first")
        change = pl.col(f"{name}_mean") - pl.col("_other")
        arrow = pl.when(change < 0).then(pl.lit("↓")).when(change > 0).then(pl.lit("↑")).when(change == 0).then(pl.lit("="))
        shown = pl.when(pl.col(arrows.group) == arrows.of).then(arrow).alias(f"{name}_arrow")
        table = table.join(other, on=keys, how="left", maintain_order="left").with_columns(shown).drop("_other")
    return table


def _with_published(
    table: pl.DataFrame, tables: Sequence[str], names: Sequence[str], magnitudes: Sequence[str] = ()
) -> pl.DataFrame:
    """Put the cells of some published tables next to the rows whose configuration is that of the published test."""
    values: dict[str, list[Any]] = {f"{name}{suffix}": [] for name in names for suffix in REFERENCE_COLUMNS}
    differs: list[str | None] = []
    for row in table.iter_rows(named=True):
        standing = [one for one in row[STANDING] or [] if one["table"] in tables]
        equal = [one for one in standing if not one["differs"]]
        for name in names:
            found = next(filter(None, (_cells().get((one["table"], one["cell"], name)) for one in equal)), None)
            printed = any((one["table"], one["cell"], name) in _cells() for one in standing)
            for suffix, value in zip(REFERENCE_COLUMNS, (*(found or (None, None, None)), printed), strict=True):
                values[f"{name}{suffix}"].append(value)
        why = [one["differs"] for one in standing if any((one["table"], one["cell"], name) in _cells() for name in names)]
        differs.append(None if equal or not why else why[0])
    kinds = [kind for _ in names for kind in REFERENCE_COLUMNS.values()]
    table = table.with_columns(pl.Series(name, values[name], kind) for name, kind in zip(values, kinds, strict=True))
    for name in names:
        ours, theirs = pl.col(f"{name}_mean"), pl.col(f"{name}_published_mean")
        difference = ours.abs() - theirs.abs() if name in magnitudes else ours - theirs
        std = pl.col(f"{name}_published_std")
        table = table.with_columns(difference.alias(f"{name}_difference"))
        unit = pl.when(std > 0).then(std)
        table = table.with_columns((pl.col(f"{name}_difference") / unit).alias(f"{name}_difference_in_std"))
    return table.drop(STANDING).with_columns(pl.Series("published_differs", differs, pl.String))


@lru_cache(maxsize=1)
def _cells() -> dict[tuple[str, str, str], tuple[float, float | None, int]]:
    return {
        (cell["table"], " ".join(cell_key(cell)), cell["indicator"]): (cell["mean"], cell["std"], cell["decimals"])
        for cell in published_cells().iter_rows(named=True)
    }
