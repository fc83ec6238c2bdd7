"""Aggregate indicators into the declared tables, and set them beside the published values."""

from __future__ import annotations

from collections.abc import Sequence

import polars as pl

from hjcamp.report.declared import TableDefinition
from hjcamp.report.indicators import CHOICES, INDICATORS
from hjcamp.report.published import CONDITION, MEASURED_WITH, published_cells

#: From how many published deviations on a difference is marked.
FAR_OFF = 2.0


def aggregate(indicators: pl.DataFrame, keys: Sequence[str], names: Sequence[str] = INDICATORS) -> pl.DataFrame:
    """Return ``<indicator>_mean``, ``<indicator>_std`` (sample) and ``n`` for each group of equal ``keys``.

    Choices that vary beyond the keys become keys as well, so that different conditions are never averaged. The order is
    that of first appearance.
    """
    frame = _with_defaults(indicators)
    spare = [group for group in CHOICES if group not in keys and frame[group].n_unique() > 1]
    keys = [*keys, *spare]
    if "condition" in frame.columns and "condition" not in keys and frame.height:
        per_group = frame.group_by(keys).agg(pl.col("condition").n_unique())["condition"].max()
        keys = [*keys, "condition"] if isinstance(per_group, int) and per_group > 1 else keys
    numbers = [pl.col(name).mean().alias(f"{name}_mean") for name in names]
    numbers += [pl.col(name).std().alias(f"{name}_std") for name in names]
    ordered = [
        expression for pair in zip(numbers[: len(names)], numbers[len(names) :], strict=True) for expression in pair
    ]
    return frame.group_by(keys, maintain_order=True).agg(*ordered, pl.len().cast(pl.Int64).alias("n"))


def build_table(indicators: pl.DataFrame, definition: TableDefinition, against: str | None = None) -> pl.DataFrame:
    """Return the aggregated frame of one declared table: its choices, ``<indicator>_mean``, ``_std``, ``n``.

    With arrows declared, ``<indicator>_arrow`` is ↓, ↑ or =. With ``against="published"`` each indicator has
    ``_published_mean``, ``_published_std``, ``_difference`` and ``_difference_in_std`` beside it (null where the thesis
    prints nothing). Rows without tests are left out; no rows at all is an empty frame.
    """
    frame = _with_defaults(indicators)
    for group, names in definition.where.items():
        frame = frame.filter(pl.col(group).is_in(names))
    for group, names in definition.by.items():
        frame = frame.filter(pl.col(group).is_in(names)) if names else frame
    if definition.across:
        matches = [
            pl.all_horizontal(pl.col(group) == name for group, name in c.where.items()) for c in definition.across
        ]
        frame = frame.filter(pl.any_horizontal(matches))
    table = aggregate(frame, definition.keys, definition.indicators)
    table = table.filter(pl.any_horizontal(pl.col(f"{name}_mean").is_not_null() for name in definition.indicators))
    positions = [_position(group, names) for group, names in definition.by.items() if names]
    table = table.sort(positions, maintain_order=True) if positions else table
    if definition.arrows:
        table = _with_arrows(table, definition)
    if against == "published":
        table = _beside_published(table, definition)
    return table


def by_condition(indicators: pl.DataFrame, against: str | None = "published") -> pl.DataFrame:
    """Return one row per condition with means, deviations and n, and the published values beside them."""
    table = aggregate(indicators, ["condition", "campaign", *CHOICES])
    if against is None:
        return table
    cells = published_cells().filter(pl.col("table").is_in(["5.4.1", "5.4.2", "5.5.1", "5.5.2", "5.6.1"]))
    return _join_published(table, cells, INDICATORS)


def against_published(indicators: pl.DataFrame, definitions: Sequence[TableDefinition]) -> pl.DataFrame:
    """Return every published cell that the tests cover, one row each.

    Columns: table, title, the choices, indicator, mean, std, n, published_mean, published_std, difference,
    difference_in_std (null where the thesis prints no deviation).
    """
    parts = []
    for definition in definitions:
        table = build_table(indicators, definition, "published")
        for name in definition.indicators:
            columns = [pl.col(group) for group in CHOICES if group in table.columns]
            values = ("mean", "std", "published_mean", "published_std", "difference", "difference_in_std")
            part = table.select(
                pl.lit(definition.name).alias("table"),
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
    keys = [
        name for name in table.columns if name in (*CHOICES, "condition") and name not in (arrows.group, "condition")
    ]
    for name in arrows.indicators:
        other = table.filter(pl.col(arrows.group) == arrows.against)
        other = other.select(*keys, pl.col(f"{name}_mean").alias("_other")).unique(keys, keep="first")
        change = pl.col(f"{name}_mean") - pl.col("_other")
        arrow = (
            pl.when(change < 0).then(pl.lit("↓")).when(change > 0).then(pl.lit("↑")).when(change == 0).then(pl.lit("="))
        )
        shown = pl.when(pl.col(arrows.group) == arrows.of).then(arrow).alias(f"{name}_arrow")
        table = table.join(other, on=keys, how="left", maintain_order="left").with_columns(shown).drop("_other")
    return table


def _beside_published(table: pl.DataFrame, definition: TableDefinition) -> pl.DataFrame:
    cells = published_cells().filter(pl.col("table").is_in(definition.published))
    for group, names in definition.where.items():
        fixed = group not in table.columns and group in CONDITION and len(names) == 1
        table = table.with_columns(pl.lit(names[0]).alias(group)) if fixed else table
    return _join_published(table, cells, definition.indicators, definition.magnitudes)


def _join_published(
    table: pl.DataFrame, cells: pl.DataFrame, names: Sequence[str], magnitudes: Sequence[str] = ()
) -> pl.DataFrame:
    keys = [name for name in CONDITION if name in table.columns]
    for name in names:
        mean, std = f"{name}_published_mean", f"{name}_published_std"
        chosen = cells.filter(pl.col("indicator") == name).select(
            *keys, pl.col("mean").alias(mean), pl.col("std").alias(std), pl.col("decimals").alias(f"{name}_decimals")
        )
        table = table.join(chosen.unique(keys, keep="first"), on=keys, how="left", maintain_order="left")
        ours, theirs = pl.col(f"{name}_mean"), pl.col(mean)
        difference = ours.abs() - theirs.abs() if name in magnitudes else ours - theirs
        unit = pl.when(pl.col(std) > 0).then(pl.col(std))
        table = table.with_columns(difference.alias(f"{name}_difference"))
        table = table.with_columns((pl.col(f"{name}_difference") / unit).alias(f"{name}_difference_in_std"))
    return table
