"""Hold a comparison with the published values against tolerances."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from hjcamp.errors import UsageError, unknown
from hjcamp.report.indicators import CHOICES, INDICATORS
from hjcamp.yaml_file import read_yaml

DEFAULT = Path(__file__).with_name("default_tolerances.yaml")
KINDS = ("absolute", "published_std")
Tolerances = dict[str, dict[str, float]]


@dataclass(frozen=True)
class Violation:
    """One cell outside its tolerance."""

    table: str
    cell: str
    indicator: str
    mean: float
    published: float
    difference: float
    difference_in_std: float | None
    allowed: str
    condition: str = ""

    def __str__(self) -> str:
        in_std = f", {self.difference_in_std:+.1f} published std" if self.difference_in_std is not None else ""
        return (
            f"{self.table}: {self.cell}: {self.indicator} {self.mean:.2f}, published {self.published:g}"
            f" ({self.difference:+.2f}{in_std}; allowed {self.allowed})"
        )


def read_tolerances(source: str | Path) -> Tolerances:
    """Return the tolerances of a YAML file, or the program's own for ``default``; `UsageError` for bad ones.

    The file maps indicators to ``absolute`` (deg) and/or ``published_std`` (published standard deviations); a cell
    passes when it is within any one given. Indicators that are not named are not checked.
    """
    path = DEFAULT if str(source) == "default" else Path(source)
    if not path.exists():
        raise UsageError(f"tolerances {path}: there is no such file; a YAML file or 'default' is needed")
    content = read_yaml(path)
    if not isinstance(content, dict) or not content:
        raise UsageError(f"tolerances {path}: indicators with their tolerances are needed")
    for name, limits in content.items():
        if name not in INDICATORS:
            raise unknown("indicator", str(name), INDICATORS, f"tolerances {path}")
        if not isinstance(limits, dict) or not limits:
            raise UsageError(f"tolerances {path}: {name} needs {' or '.join(KINDS)}")
        for kind, limit in limits.items():
            if kind not in KINDS:
                raise unknown("tolerance", str(kind), KINDS, f"tolerances {path}: {name}")
            if isinstance(limit, bool) or not isinstance(limit, (int, float)) or not 0.0 <= limit < math.inf:
                raise UsageError(f"tolerances {path}: {name}.{kind} is {limit!r}; a finite number >= 0 is needed")
    return content


def check(
    comparison: pl.DataFrame,
    tolerances: str | Path | Tolerances = "default",
    differs: Mapping[str, Sequence[str]] | None = None,
) -> list[Violation]:
    """Return the cells of a comparison (`hjcamp.report.tables.against_published`) that are outside the tolerances.

    `UsageError` where there is no cell to check, because an empty comparison must not pass; ``differs`` are the reasons
    why no published value stands beside some conditions.
    """
    limits = tolerances if isinstance(tolerances, dict) else read_tolerances(tolerances)
    cells = [cell for cell in comparison.iter_rows(named=True) if cell["indicator"] in limits]
    if not cells:
        why = "".join(f"; {len(names)} of them: {reason}" for reason, names in list((differs or {}).items())[:3])
        raise UsageError(f"nothing to check: none of these conditions has a published value with a tolerance{why}")
    return [
        _violation(cell, limits[cell["indicator"]]) for cell in cells if not _within(cell, limits[cell["indicator"]])
    ]


def _within(cell: dict[str, Any], limits: dict[str, float]) -> bool:
    in_unit = {"absolute": cell["difference"], "published_std": cell["difference_in_std"]}
    # A null or NaN difference compares false with everything, so it never passes.
    return any(in_unit[kind] is not None and abs(in_unit[kind]) <= limit for kind, limit in limits.items())


def _violation(cell: dict[str, Any], limits: dict[str, float]) -> Violation:
    units = {"absolute": "deg", "published_std": "published std"}
    name = " ".join(cell[group] for group in CHOICES if cell.get(group) is not None)
    name += f" ({cell['condition']})" if cell.get("condition") else ""
    allowed = " or ".join(f"{limit:g} {units[kind]}" for kind, limit in limits.items())
    return Violation(
        table=cell["table"],
        cell=name,
        indicator=cell["indicator"],
        mean=_number(cell["mean"]),
        published=cell["published_mean"],
        difference=_number(cell["difference"]),
        difference_in_std=cell["difference_in_std"],
        allowed=allowed,
        condition=str(cell.get("condition")),
    )


def _number(value: float | None) -> float:
    return float("nan") if value is None else value
