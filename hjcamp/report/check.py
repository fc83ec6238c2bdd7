"""Hold a comparison with the published values, or with another run, against tolerances."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from hjcamp.errors import UsageError, unknown
from hjcamp.report.runs.indicators import CHOICES, INDICATORS
from hjcamp.yaml_file import read_yaml

#: What the means are held against: the kinds of tolerances that it allows, and the program's own.
KINDS = {"published": ("absolute", "published_std"), "baseline": ("absolute", "baseline_std", "p")}
DEFAULT = {name: Path(__file__).with_name(f"default_tolerances_{name}.yaml") for name in KINDS}
UNITS = {"absolute": "deg", "published_std": "published std", "baseline_std": "std of the baseline"}
Tolerances = dict[str, dict[str, float]]


@dataclass(frozen=True)
class Violation:
    """One mean outside its tolerance; ``table`` names every table in which what is next to it is printed."""

    table: str
    cell: str
    indicator: str
    mean: float
    published: float
    difference: float
    difference_in_std: float | None
    allowed: str
    condition: str = ""
    reference: str = "published"
    p: float | None = None

    def __str__(self) -> str:
        cell, indicator, mean, reference, difference, allowed, tables = self.row
        return f"{tables}: {cell}: {indicator} {mean}, {self.reference} {reference} ({difference}; allowed {allowed})"

    @property
    def row(self) -> tuple[str, ...]:
        """Condition, indicator, mean, the reference, difference, allowed, tables; as texts."""
        in_std = f", {self.difference_in_std:+.1f} {self.reference} std" if self.difference_in_std is not None else ""
        chance = f", p {self.p:.2g}" if self.p is not None else ""
        # Means of two runs may differ by less than the print of a text shows.
        digits = 2 if self.reference == "published" else 4
        return (
            self.cell,
            self.indicator,
            f"{self.mean:.{digits}f}",
            f"{self.published:{'g' if digits == 2 else '.4f'}}",
            f"{self.difference:+.{digits}f}{in_std}{chance}",
            self.allowed,
            self.table,
        )


def read_tolerances(source: str | Path, reference: str = "published") -> Tolerances:
    """Return the tolerances of a YAML file, or the program's own for ``default``; `UsageError` for bad ones.

    The file maps indicators to ``absolute`` (deg) and/or ``published_std`` (published standard deviations); next to a
    baseline ``baseline_std`` (its deviations) or ``p`` (a mean passes whose corrected p is not below it). A cell passes
    when it is within any one given. Indicators that are not named are not checked.
    """
    kinds = KINDS[reference]
    path = DEFAULT[reference] if str(source) == "default" else Path(source)
    if not path.exists():
        raise UsageError(f"tolerances {path}: there is no such file; a YAML file or 'default' is needed")
    content = read_yaml(path)
    if not isinstance(content, dict) or not content:
        raise UsageError(f"tolerances {path}: indicators with their tolerances are needed")
    for name, limits in content.items():
        if name not in INDICATORS:
            raise unknown("indicator", str(name), INDICATORS, f"tolerances {path}")
        if not isinstance(limits, dict) or not limits:
            raise UsageError(f"tolerances {path}: {name} needs {' or '.join(kinds)}")
        for kind, limit in limits.items():
            if kind not in kinds:
                raise unknown("tolerance", str(kind), kinds, f"tolerances {path}: {name}")
            if isinstance(limit, bool) or not isinstance(limit, (int, float)) or not 0.0 <= limit < math.inf:
                raise UsageError(f"tolerances {path}: {name}.{kind} is {limit!r}; a finite number >= 0 is needed")
    return content


def check(
    comparison: pl.DataFrame,
    tolerances: str | Path | Tolerances = "default",
    differs: Mapping[str, Sequence[str]] | None = None,
) -> list[Violation]:
    """Return the cells of a comparison (`tables.aggregation.against_published`, `RunComparison.cells`) outside tolerances.

    `UsageError` where there is no cell to check, because an empty comparison must not pass; ``differs`` are the reasons
    why no published value stands next to some conditions.
    """
    limits = tolerances if isinstance(tolerances, dict) else read_tolerances(tolerances, _reference(comparison))
    groups = means_of(comparison, limits)
    if not groups:
        why = "".join(f"; {len(names)} of them: {reason}" for reason, names in list((differs or {}).items())[:3])
        raise UsageError(
            f"nothing to check: none of these conditions has a {_reference(comparison)} value with a tolerance{why}"
        )
    found = []
    for (_, indicator), cells in groups.items():
        outside = [cell for cell in cells if not _within(cell, limits[indicator])]
        if outside:
            found.append(_violation(outside[0], limits[indicator], _reference(comparison), tables_of(cells)))
    return found


def means_of(comparison: pl.DataFrame, checked: Container[str]) -> dict[tuple[str, str], list[dict[str, Any]]]:
    """Return the cells of each mean by condition and indicator: a published mean may be printed in several tables."""
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for cell in comparison.iter_rows(named=True):
        if cell["indicator"] in checked:
            found.setdefault((str(cell["condition"]), cell["indicator"]), []).append(cell)
    return found


def tables_of(cells: Sequence[Mapping[str, Any]]) -> str:
    """Return the tables of some cells, with commas."""
    return ", ".join(dict.fromkeys(cell["table"] for cell in cells))


def _reference(comparison: pl.DataFrame) -> str:
    return "baseline" if "baseline_mean" in comparison.columns else "published"


def _within(cell: dict[str, Any], limits: dict[str, float]) -> bool:
    in_std = cell["difference_in_std"]
    in_unit = {"absolute": cell["difference"], "published_std": in_std, "baseline_std": in_std}
    if "p" in limits and cell["p_holm"] is not None and cell["p_holm"] >= limits["p"]:
        return True
    limits = {kind: limit for kind, limit in limits.items() if kind != "p"}
    # A null or NaN difference compares false with everything, so it never passes.
    return any(in_unit[kind] is not None and abs(in_unit[kind]) <= limit for kind, limit in limits.items())


def _violation(cell: dict[str, Any], limits: dict[str, float], reference: str, tables: str) -> Violation:
    name = " ".join(cell[group] for group in CHOICES if cell.get(group) is not None)
    name = f"{name} ({cell['condition']})" if name and cell.get("condition") else name or str(cell["condition"])
    allowed = " or ".join(
        f"p from {limit:g} on" if kind == "p" else f"{limit:g} {UNITS[kind]}" for kind, limit in limits.items()
    )
    return Violation(
        table=tables,
        cell=name,
        indicator=cell["indicator"],
        mean=_number(cell["mean"]),
        published=cell[f"{reference}_mean"],
        difference=_number(cell["difference"]),
        difference_in_std=cell["difference_in_std"],
        allowed=allowed,
        condition=str(cell.get("condition")),
        reference=reference,
        p=cell.get("p_holm"),
    )


def _number(value: float | None) -> float:
    return float("nan") if value is None else value
